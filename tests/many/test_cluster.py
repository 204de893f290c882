"""A Ray cluster of which a machine dies in the middle: nothing lost, nothing twice, the same figures."""

import contextlib
import csv
import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
import types
from pathlib import Path

import psutil
import pytest

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parent.parent / "cli"))
from command import run_anew as run
from command import started_anew
from jobs_of_tests import Diary, Errand

from weingarten.errors import MissingExtraError, OptionError
from weingarten.io.cloud_file import write_cloud
from weingarten.many.cluster import GPU_SHARE, TRIES, Ray, done
from weingarten.many.parcel import Parcel
from weingarten.many.threads import Threads
from weingarten.samples.parts import sample_part

SHORT = ["--steps", "30", "--points-per-step", "100", "--resolution", "32"]
with_ray = pytest.mark.skipif(importlib.util.find_spec("ray") is None, reason="Ray is not installed")


class Exceptions:
    """Ray's errors."""

    class RayError(Exception):
        """Whatever befalls a machine."""

    class RayTaskError(RayError):
        """What a task has raised."""

        def __init__(self, cause: Exception) -> None:
            self.cause = cause


class Pretended:
    """A cluster of two cores that does what it is given when it is asked for it; loses jobs so many times."""

    exceptions = Exceptions

    def __init__(self, losses: dict[str, int], gpus: int = 0) -> None:
        self.losses, self.there = losses, {"CPU": 2.0, "GPU": float(gpus)}
        self.given: list[tuple] = []
        self.most = 0

    def remote(self, **options):
        self.options = options
        return lambda function: types.SimpleNamespace(remote=lambda *words: self.take(function, words))

    def take(self, function, words) -> int:
        self.given.append((function, words))
        return len(self.given) - 1

    def wait(self, references, num_returns, timeout):
        self.most = max(self.most, len(references))
        return references[:num_returns], references[num_returns:]

    def get(self, reference):
        function, words = self.given[reference]
        name = words[0].jobs[0].name
        if self.losses.get(name, 0) > 0:
            self.losses[name] -= 1
            raise Exceptions.RayError("The node died.\nAnd more.")
        try:
            return function(*words)
        except Exception as error:
            raise Exceptions.RayTaskError(error) from error

    def cluster_resources(self):
        return self.there

    def nodes(self):
        return [{"Alive": True, "Resources": self.there}, {"Alive": False, "Resources": {"CPU": 64}}]


def performed(pretended: Pretended, folder: Path, *names: str, cpus: int = 1) -> Diary:
    """Have jobs of these names done by a cluster."""
    ray, diary = Ray(os.getpid, "local", cpus), Diary()
    ray.ray = pretended
    assert ray.device("auto") == ("cuda" if pretended.there["GPU"] else "cpu")
    ray.perform([[Errand(folder, name)] for name in names], diary)
    return diary


def test_lost_jobs_are_given_away_again_but_not_for_ever(tmp_path: Path):
    pretended = Pretended({"b": TRIES - 1, "c": 100})
    diary = performed(pretended, tmp_path, "a", "b", "c", "fail", "raise")
    assert sorted(diary.begun) == sorted(diary.ended) == ["a", "b", "c", "fail", "raise"]
    assert len(diary.notes) == TRIES - 1 + TRIES
    for name in ("a", "b"):
        assert not Errand(tmp_path, name).error
        assert len((tmp_path / name / "calls").read_text().split()) == 1
    assert Errand(tmp_path, "c").error == (
        f"It was lost with its machine {TRIES} times, the last time by: The node died."
    )
    assert Errand(tmp_path, "fail").error == "None is too hard."
    assert Errand(tmp_path, "raise").error == "ValueError: unforeseen"


def test_a_file_that_is_gone_fails_its_own_job_alone(tmp_path: Path):
    ray, diary = Ray(os.getpid, "local", 1), Diary()
    ray.ray = Pretended({})
    gone, there = Errand(tmp_path, "gone", tmp_path / "gone.ply"), Errand(tmp_path, "there")
    ray.perform([[gone], [there]], diary)
    assert gone.error == f"{tmp_path / 'gone.ply'} cannot be read: No such file or directory."
    assert not there.error
    assert sorted(diary.ended) == ["gone", "there"]


def test_no_more_is_handed_out_than_the_cluster_has_use_for(tmp_path: Path):
    pretended = Pretended({})
    performed(pretended, tmp_path, *map(str, range(9)))
    assert pretended.most == 4
    wanted = {name: pretended.options[name] for name in ("num_cpus", "num_gpus", "max_retries")}
    assert wanted == {"num_cpus": 1, "num_gpus": 0.0, "max_retries": 0}
    assert pretended.options["runtime_env"]["env_vars"]["OMP_NUM_THREADS"] == "1"


def test_machines_with_another_version_make_nothing(tmp_path: Path):
    with pytest.raises(OptionError, match=r"install the same version"):
        done(Parcel.of([Errand(tmp_path, "a")]), os.getpid, Threads(1), "0.0")


def test_fits_share_a_gpu(tmp_path: Path):
    pretended = Pretended({}, gpus=1)
    performed(pretended, tmp_path, "a")
    assert pretended.options["num_gpus"] == GPU_SHARE


def test_no_machine_that_is_large_enough_is_said(tmp_path: Path):
    (note,) = performed(Pretended({}), tmp_path, "a", cpus=3).notes
    assert "3 cores" in note


def test_without_ray_its_installation_is_told(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with (
        pytest.raises(MissingExtraError, match=r'pip install "weingarten\[ray\]"'),
        Ray(os.getpid, "auto").working(),
    ):
        pass


def test_devices_that_are_none(tmp_path: Path):
    with pytest.raises(OptionError, match="no device 'gpu'"):
        Ray(os.getpid, "auto").device("gpu")


@pytest.fixture
def machines():
    """Address of a cluster, and the processes that are its two machines."""
    script = Path(__file__).with_name("two_machines.py")
    process = subprocess.Popen(
        [sys.executable, str(script)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "RAY_USAGE_STATS_ENABLED": "0", "OMP_NUM_THREADS": "1"},
    )
    assert process.stdin is not None
    assert process.stdout is not None
    found = json.loads(process.stdout.readline())
    yield found["address"], [psutil.Process(pid) for pid in found["raylets"]]
    process.stdin.close()
    process.wait(60)
    process.stdout.close()


def at_work(machine: psutil.Process) -> bool:
    """Whether it does a job, as Ray writes into the names of its processes."""
    with contextlib.suppress(psutil.NoSuchProcess):
        return any("ray::done" in " ".join(one.cmdline()) for one in machine.children(recursive=True))
    return False


def destroy(machine: psutil.Process) -> None:
    """End it and all that runs on it, as a power cut would."""
    for process in (machine, *machine.children(recursive=True)):
        with contextlib.suppress(psutil.NoSuchProcess):
            process.send_signal(signal.SIGKILL)


def rows(out: Path) -> list[dict[str, str]]:
    with (out / "results.csv").open(newline="", encoding="utf-8") as stream:
        return [
            {key: text for key, text in row.items() if not key.endswith("seconds")}
            for row in csv.DictReader(stream)
        ]


@pytest.fixture
def scans(tmp_path: Path) -> Path:
    """Six scans, and a file that is none."""
    folder = tmp_path / "scans"
    folder.mkdir()
    for name in ("block", "bracket", "flange"):
        for seed in (0, 1):
            write_cloud(folder / f"{name}{seed}.ply", sample_part(name, 2000, seed))
    (folder / "cut.ply").write_text("ply\n")
    return folder


def wait_for_work(process: subprocess.Popen, out: Path, machines: list[psutil.Process]) -> None:
    """Until one fit is done and a machine is at another."""
    deadline = time.monotonic() + 120
    while not (list(out.glob("*/mesh.ply")) and any(map(at_work, machines))):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.05)


def finished(out: Path) -> dict[str, int]:
    """When the record of every fit that is done was written."""
    records = {path.parent.name: path for path in out.glob("*/fit.json")}
    return {
        name: path.stat().st_mtime_ns
        for name, path in records.items()
        if json.loads(path.read_text())["status"] == "done"
    }


@pytest.mark.slow
@with_ray
def test_a_machine_that_dies_costs_nothing_but_time(tmp_path: Path, scans: Path, machines):
    address, both = machines
    out = tmp_path / "cluster"
    process = started_anew("fit", scans, "-o", out, "--ray", address, *SHORT)
    wait_for_work(process, out, both)
    destroy(next(filter(at_work, both)))
    _, errors = process.communicate(timeout=300)
    assert process.returncode == 1, errors
    assert f"lost with its machine at try 1 of {TRIES}" in errors
    assert errors.count(": done") == 6
    code, _, errors = run("fit", scans, "-o", tmp_path / "here", "--jobs", 1, "--cpus-per-fit", 1, *SHORT)
    assert code == 1, errors
    assert rows(out) == rows(tmp_path / "here")
    assert [row["status"] for row in rows(out)].count("done") == 6
    assert f"{scans / 'cut.ply'} cannot be read" in json.loads((out / "cut/fit.json").read_text())["error"]
    for name in ("mesh.ply", "checkpoint.safetensors", "cloud.npy"):
        for folder in (tmp_path / "here").glob("*[01]"):
            assert (out / folder.name / name).read_bytes() == (folder / name).read_bytes()
    code, _, errors = run("fit", scans, "-o", out, "--quiet", *SHORT)
    assert code == 1
    assert rows(out) == rows(tmp_path / "here")


@pytest.mark.slow
@with_ray
def test_a_command_that_dies_costs_the_running_fits_alone(tmp_path: Path, scans: Path, machines):
    """By signal 9: its cluster stops what it had begun, and the same command goes on."""
    address, both = machines
    out = tmp_path / "cluster"
    words = ("fit", scans, "-o", out, "--ray", address, *SHORT)
    process = started_anew(*words)
    wait_for_work(process, out, both)
    process.kill()
    process.communicate()
    before = finished(out)
    assert 0 < len(before) < 6
    deadline = time.monotonic() + 60
    while any(map(at_work, both)):
        assert time.monotonic() < deadline, "the cluster works for nobody"
        time.sleep(0.05)
    assert finished(out) == before
    code, _, errors = run(*words)
    assert code == 1, errors
    after = finished(out)
    assert len(after) == 6
    assert {name: after[name] for name in before} == before
    code, _, errors = run("fit", scans, "-o", tmp_path / "here", "--jobs", 1, "--cpus-per-fit", 1, *SHORT)
    assert code == 1, errors
    assert rows(out) == rows(tmp_path / "here")

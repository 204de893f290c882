"""`weingarten fit` on a folder of clouds, as a user's shell would run it."""

import csv
import io
import json
import os
import shlex
import signal
import sys
import time
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from command import Started, run, temporaries

from weingarten.cli.main import main
from weingarten.io.cloud_file import write_cloud
from weingarten.many.workers import Workers, perform
from weingarten.samples.parts import sample_part

SHORT = ["--steps", "30", "--points-per-step", "100", "--resolution", "32", "--sharp", "off"]
"""Handles of a field of so few steps are many, and to undo them takes several times as long as the fit."""


@pytest.fixture(scope="module")
def scans(tmp_path_factory) -> Path:
    """Three clouds, two of which differ in the extension alone, and a file that is none."""
    folder = tmp_path_factory.mktemp("scans")
    write_cloud(folder / "flange.ply", sample_part("flange", 1200, 0))
    write_cloud(folder / "flange.xyz", sample_part("flange", 1200, 1))
    write_cloud(folder / "block.npy", sample_part("block", 1200, 0))
    (folder / "cut.ply").write_bytes((folder / "flange.ply").read_bytes()[:5000])
    return folder


class Here(Workers):
    """Fits in this process, which spares the start of another."""

    def perform(self, batches, watcher) -> None:
        for batch in batches:
            watcher.begin(batch)
            perform(batch)
            watcher.end(batch)


def stay(patch: pytest.MonkeyPatch) -> None:
    """What is asked of the command in this process is done in it; where that is, is not asked a process."""
    patch.setattr("weingarten.cli.fit_folder.crowd_of", lambda *_, **__: Here(os.getpid))
    patch.setattr("weingarten.report.provenance.origin", lambda threads: {"commit": "c"})


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """See `stay`."""
    stay(monkeypatch)


@pytest.fixture(scope="module")
def finished(scans, tmp_path_factory) -> tuple[Path, str, str]:
    """The folder of all fits; what the command said."""
    out, text, errors = tmp_path_factory.mktemp("finished") / "out", io.StringIO(), io.StringIO()
    words = ["fit", str(scans), "-o", str(out), "--picture", "seen.png", *SHORT]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(text), redirect_stderr(errors):
        stay(patch)
        assert main(words) == 1, errors.getvalue()
    return out, text.getvalue(), errors.getvalue()


def rows(out: Path) -> dict[str, dict[str, str]]:
    with (out / "results.csv").open(newline="", encoding="utf-8") as stream:
        return {row["name"]: row for row in csv.DictReader(stream)}


def test_a_run_folder_for_each_and_failures_alone(finished):
    out, text, errors = finished
    found = rows(out)
    assert {name: row["status"] for name, row in found.items()} == {
        "block": "done",
        "cut": "failed",
        "flange.ply": "done",
        "flange.xyz": "done",
    }
    assert "3 of 4 done" in text
    assert "cut.ply failed: " in errors
    assert "cannot be read" in found["cut"]["error"]
    assert "Traceback" not in errors
    names = {path.name for path in (out / "block").iterdir()}
    kept = {"config.toml", "loss.csv", "checkpoint.safetensors", "cloud.npy", "mesh.ply", "summary.json"}
    assert names == kept | {"history", "made.json", "fit.json", "log.txt", "seen.png"}
    assert "Step 30 of 30" in (out / "block/log.txt").read_text()
    assert not temporaries(out)
    assert not temporaries(out / "block")


def test_each_run_folder_says_how_it_is_made_alone(finished, scans):
    folder = finished[0] / "block"
    made = json.loads((folder / "made.json").read_text())
    assert made["commit"] == "c"
    assert made["device"] == "cpu"
    words = shlex.split(made["command"])
    assert words[:5] == ["weingarten", "fit", str(scans / "block.npy"), "-o", str(folder / "mesh.ply")]
    assert words[5:] == ["--run", str(folder), *SHORT]


def test_the_table_says_what_the_summaries_say(finished):
    out = finished[0]
    entries = {entry["name"]: entry for entry in json.loads((out / "results.json").read_text())}
    for name, row in rows(out).items():
        assert entries[name]["error"] == row["error"]
        if row["status"] == "done":
            summary = json.loads((out / name / "summary.json").read_text())
            assert float(row["distance_mean"]) == entries[name]["distance_mean"] == summary["distance_mean"]
            assert row["watertight"] == str(summary["watertight"])
            assert entries[name]["doubts"] == summary["doubts"]
            assert float(row["seconds"]) > 0


def test_a_fit_of_many_is_the_one_it_is_alone(finished, scans, tmp_path):
    words = ["fit", str(scans / "block.npy"), "-o", str(tmp_path / "block.ply"), "--quiet", *SHORT]
    assert main(words) == 0
    assert (tmp_path / "block.ply").read_bytes() == (finished[0] / "block/mesh.ply").read_bytes()


def test_what_is_finished_is_never_made_again(finished, scans, capsys, here):
    out = finished[0]
    before = {path: path.stat().st_mtime_ns for path in out.glob("*/*")}
    words = ["fit", str(scans), "-o", str(out), "--picture", "seen.png", "--json", *SHORT]
    assert main(words) == 1
    said = capsys.readouterr()
    assert "4 of them done before" in said.err
    assert json.loads(said.out) == json.loads((out / "results.json").read_text())
    assert {path: path.stat().st_mtime_ns for path in out.glob("*/*")} == before


def test_other_settings_in_the_same_place_are_refused(finished, scans, capsys, here):
    assert main(["fit", str(scans), "-o", str(finished[0]), "--steps", "31", *SHORT[2:]]) == 2
    assert "other settings" in capsys.readouterr().err


def test_a_kill_costs_nothing_and_the_fit_goes_on_from_its_checkpoint(scans, tmp_path):
    folder, out = tmp_path / "scans", tmp_path / "out"
    folder.mkdir()
    for name in ("block.npy", "cut.ply"):
        (folder / name).write_bytes((scans / name).read_bytes())
    words = ["fit", folder, "-o", out, "--jobs", 2, "--cpus-per-fit", 1, "--steps", 400, *SHORT[2:]]
    process = Started(*words, alone=True)
    curve = out / "block/loss.csv"
    deadline = time.monotonic() + 120
    while not (curve.exists() and len(curve.read_text().splitlines()) > 5):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert json.loads((out / "block/fit.json").read_text())["status"] == "begun"
    assert rows(out)["cut"]["status"] == "failed"
    tried = (out / "cut/fit.json").stat().st_mtime_ns
    code, _, errors = run(*words)
    assert code == 1, errors
    assert "2 fits, 1 of them done before" in errors
    assert (out / "cut/fit.json").stat().st_mtime_ns == tried
    assert rows(out)["block"]["status"] == "done"
    assert (out / "block/log.txt").read_text().count("Fitting.") == 2
    with curve.open(newline="") as stream:
        assert [int(row["step"]) for row in csv.DictReader(stream)] == list(range(400))


def test_what_failed_is_tried_again_on_demand_or_when_it_has_changed(scans, tmp_path, here):
    folder, out = tmp_path / "scans", tmp_path / "out"
    folder.mkdir()
    (folder / "a.xyz").write_text("0 0 0\n")
    words = ["fit", str(folder), "-o", str(out), *SHORT]
    assert main(words) == 1
    assert main([*words, "--retry"]) == 1
    assert (out / "a/log.txt").read_text().count("Failed") == 2
    assert main(words) == 1
    assert (out / "a/log.txt").read_text().count("Failed") == 2
    (folder / "a.xyz").write_bytes((scans / "flange.xyz").read_bytes())
    assert main(words) == 0
    assert rows(out)["a"]["error"] == ""


def test_shards_are_all_of_it(tmp_path, capsys, here):
    folder = tmp_path / "scans"
    folder.mkdir()
    for name in "abc":
        (folder / f"{name}.xyz").write_text("0 0 0\n")
    for share in ("1/2", "2/2"):
        assert main(["fit", str(folder), "-o", str(tmp_path / "out"), "--shard", share]) == 1
    assert "2 fits, 0 of them done before" in capsys.readouterr().err
    assert set(rows(tmp_path / "out")) == {"a", "b", "c"}


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--jobs", "0"], "--jobs"),
        (["--cpus-per-fit", "0"], "--cpus-per-fit"),
        (["--gpus-per-fit", "0.5"], "--ray"),
        (["--ray", "auto", "--jobs", "2"], "--jobs"),
        (["--ray", "auto", "--gpus-per-fit", "-1"], "--gpus-per-fit"),
        (["--shard", "3/2"], "--shard"),
        (["--run", "x"], "--run"),
        (["--resume"], "--resume"),
        (["--oracle", "bundled:flange"], "weingarten bench"),
        (["--page", "page.html"], "weingarten report OUT/NAME"),
        (["--picture", "a/b.png"], "--picture"),
        (["--picture", "b.bmp"], "b.bmp"),
        (["--steps", "0"], "--steps"),
        (["--device", "gpu"], "gpu"),
    ],
)
def test_mistakes_end_in_one_sentence(scans, tmp_path, capsys, options, sentence):
    assert main(["fit", str(scans), "-o", str(tmp_path / "out"), *options]) == 2
    error = capsys.readouterr().err
    assert sentence in error
    assert len(error.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_places_that_cannot_be(scans, tmp_path, capsys):
    assert main(["fit", str(scans), "-o", str(scans)]) == 2
    assert "the folder of the clouds" in capsys.readouterr().err
    (tmp_path / "file").touch()
    assert main(["fit", str(scans), "-o", str(tmp_path / "file")]) == 2
    assert "is a file" in capsys.readouterr().err
    (tmp_path / "empty").mkdir()
    assert main(["fit", str(tmp_path / "empty"), "-o", str(tmp_path / "out")]) == 2
    assert "holds no cloud" in capsys.readouterr().err


def test_options_of_a_folder_are_not_for_a_cloud(scans, tmp_path, capsys):
    assert main(["fit", str(scans / "flange.ply"), "-o", str(tmp_path / "a.stl"), "--jobs", "2"]) == 2
    assert "--jobs is for a folder" in capsys.readouterr().err

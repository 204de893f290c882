"""`weingarten fit` and `weingarten mesh` from outside."""

import csv
import json
import shlex
import signal
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

sys.path.insert(0, str(Path(__file__).parent))
from command import SMALL, Started, run, run_anew, temporaries

from weingarten.cli.main import main, parser
from weingarten.fit.history import steps_kept
from weingarten.io.cloud_file import write_cloud
from weingarten.io.mesh import read_mesh
from weingarten.io.points import read_points
from weingarten.metrics.distance import closest
from weingarten.metrics.topology import topology
from weingarten.samples.parts import sample_part
from weingarten.settings import PRESETS


@pytest.fixture(scope="module")
def cloud(tmp_path_factory) -> Path:
    """A small scan of a bundled part."""
    path = tmp_path_factory.mktemp("cloud") / "flange.ply"
    write_cloud(path, sample_part("flange", 4000, 0))
    return path


@pytest.fixture(scope="module")
def finished(cloud, tmp_path_factory) -> tuple[Path, str, str]:
    """A finished small fit: its folder, standard output and error."""
    folder = tmp_path_factory.mktemp("finished")
    code, out, err = run(
        *("fit", cloud, "-o", folder / "part.stl", "--run", folder / "run", "--json", "--steps", 60, *SMALL),
        *("--page", folder / "page.html"),
    )
    assert code == 0, err
    return folder, out, err


def test_writes_one_json_object_and_a_watertight_mesh_in_place(finished, cloud):
    folder, out, err = finished
    answer = json.loads(out)
    assert answer["summary"]["steps"] == 60
    assert answer["summary"]["finished"] is True
    assert "Traceback" not in err
    assert "About" in err
    assert "step 60/60" in err
    mesh, points = read_mesh(folder / "part.stl"), read_points(cloud)
    assert topology(mesh).watertight
    assert answer["summary"]["watertight"] is True
    size = np.ptp(points, axis=0).max()
    assert np.abs(mesh.bounds - [points.min(axis=0), points.max(axis=0)]).max() < 0.15 * size
    assert not temporaries(folder)


def test_run_folder_holds_what_it_should(finished):
    folder = finished[0] / "run"
    assert {path.name for path in folder.iterdir()} == {
        "config.toml",
        "loss.csv",
        "checkpoint.safetensors",
        "cloud.npy",
        "history",
        "mesh.ply",
        "summary.json",
        "made.json",
    }
    settings = tomllib.loads((folder / "config.toml").read_text())
    assert settings["steps"] == 60
    assert settings["method"] == "odw-oriented"
    with (folder / "loss.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [int(row["step"]) for row in rows] == list(range(60))
    first = rows[0]
    names = ["dirichlet", "off_surface", "free_space", "eikonal", "normals", "off_diagonal_weingarten"]
    total = sum(float(first[name]) * float(first[f"weight_{name}"]) for name in names)
    assert float(first["loss"]) == pytest.approx(total, rel=1e-6)
    summary = json.loads((folder / "summary.json").read_text())
    assert 0 < summary["distance_mean"] <= summary["distance_p95"] <= summary["distance_max"]


def test_the_record_holds_the_command_that_makes_it_again(finished, cloud):
    folder, _, _ = finished
    made = json.loads((folder / "run" / "made.json").read_text())
    again = shlex.split(made["command"])
    assert again[:2] == ["weingarten", "fit"]
    options = parser().parse_args(again[1:])
    assert (options.cloud, options.output, options.folder) == (cloud, folder / "part.stl", folder / "run")
    assert (options.steps, options.points_per_step, options.resolution) == (60, 200, 24)
    assert {"version", "commit", "machine", "date", "device"} < made.keys()


def test_its_page_is_that_of_report(finished, capsys):
    folder, _, _ = finished
    assert main(["report", str(folder / "run"), "-o", str(folder / "again.html")]) == 0
    assert capsys.readouterr().out.startswith(f"Wrote {folder / 'again.html'}: 60 steps, ")
    assert (folder / "again.html").read_bytes() == (folder / "page.html").read_bytes()


def test_same_input_and_seed_give_the_same_bytes(finished, cloud, tmp_path):
    code, _, err = run_anew("fit", cloud, "-o", tmp_path / "again.stl", "--quiet", "--steps", 60, *SMALL)
    assert code == 0
    assert err == ""
    assert (tmp_path / "again.stl").read_bytes() == (finished[0] / "part.stl").read_bytes()
    code, _, _ = run(
        "fit", cloud, "-o", tmp_path / "other.stl", "--seed", 1, "--quiet", "--steps", 60, *SMALL
    )
    assert (tmp_path / "other.stl").read_bytes() != (finished[0] / "part.stl").read_bytes()


def test_mesh_extracts_again_at_any_resolution(finished, tmp_path):
    folder = finished[0]
    code, out, _ = run("mesh", folder / "run", "-o", tmp_path / "same.stl", "--resolution", 24)
    assert code == 0
    assert "step 60 of 60" in out
    assert (tmp_path / "same.stl").read_bytes() == (folder / "part.stl").read_bytes()
    assert main(["mesh", str(folder / "run"), "-o", str(tmp_path / "fine.ply"), "--resolution", "40"]) == 0
    assert len(read_mesh(tmp_path / "fine.ply").faces) > 2 * len(read_mesh(tmp_path / "same.stl").faces)


def test_mesh_extracts_again_without_sharp_edges(finished, tmp_path):
    folder = finished[0]
    code, _, _ = run(
        "mesh", folder / "run", "-o", tmp_path / "plain.ply", "--resolution", 24, "--sharp", "off"
    )
    assert code == 0
    sharp, plain = read_mesh(folder / "part.stl"), read_mesh(tmp_path / "plain.ply")
    assert len(sharp.vertices) != len(plain.vertices)
    assert topology(plain).watertight


def test_surface_far_from_the_points_is_left_out_on_demand(finished, cloud, tmp_path, capsys):
    folder, points = finished[0] / "run", read_points(cloud)
    size = np.ptp(points, axis=0).max()
    words = ["-o", tmp_path / "open.ply", "--resolution", 24, "--trim-distance"]
    code, _, _ = run("mesh", folder, *words, 0.03 * size)
    assert code == 0
    whole, part = read_mesh(finished[0] / "part.stl"), read_mesh(tmp_path / "open.ply")
    assert 0 < len(part.faces) < len(whole.faces)
    assert KDTree(points).query(part.vertices)[0].max() < 0.03 * size
    for distance, sentence in ((1e-9 * size, "Nothing is left"), (-1, "positive"), ("nan", "positive")):
        assert sentence in refused(["mesh", folder, *words, distance], tmp_path, capsys)
    words[1] = tmp_path / "fitted.stl"
    assert run("fit", cloud, *words, 0.03 * size, "--steps", 60, "--points-per-step", 200, "--quiet")[0] == 0
    again = read_mesh(tmp_path / "fitted.stl")
    assert len(again.faces) == len(part.faces)
    np.testing.assert_allclose(again.bounds, part.bounds, atol=1e-5 * size)


def test_triangles_are_fewer_on_demand(tmp_path):
    ball = np.random.default_rng(0).normal(size=(2000, 3))
    write_cloud(tmp_path / "ball.ply", 50.0 * ball / np.linalg.norm(ball, axis=1, keepdims=True))
    length = 1.0
    words = [tmp_path / "ball.ply", "-o", tmp_path / "few.stl", "--run", tmp_path / "run", "--steps", 200]
    words += ["--points-per-step", 400, "--resolution", 32]
    code, _, err = run("fit", *words, "--simplify", length)
    assert code == 0, err
    assert run("mesh", tmp_path / "run", "-o", tmp_path / "whole.stl", "--simplify", 0)[0] == 0
    whole, few = read_mesh(tmp_path / "whole.stl"), read_mesh(tmp_path / "few.stl")
    assert f"{len(few.faces):,} triangles stand for {len(whole.faces):,}" in err
    assert len(few.faces) < 0.2 * len(whole.faces)
    assert topology(few).genus == topology(whole).genus
    assert np.quantile(closest(few, whole.vertices).distance, 0.999) < 1.001 * length
    code, _, err = run("mesh", tmp_path / "run", "-o", tmp_path / "none.stl", "--simplify", "-1")
    assert (code, "--simplify must be" in err, "Traceback" in err) == (2, True, False)
    assert not (tmp_path / "none.stl").exists()


@pytest.mark.parametrize("method", ["digs", "hash-grid"])
def test_a_fit_with_sharp_edges_is_that_of_its_run_folder(method, cloud, tmp_path):
    words = ["--method", method, "--steps", "30", *SMALL, "--quiet", "--sharp", "on"]
    assert (
        main(["fit", str(cloud), "-o", str(tmp_path / "a.stl"), "--run", str(tmp_path / "run"), *words]) == 0
    )
    for name, sharp in (("b.stl", []), ("c.stl", ["--sharp", "off"])):
        again = ["mesh", str(tmp_path / "run"), "-o", str(tmp_path / name), "--resolution", "24", *sharp]
        assert main(again) == 0
    assert (tmp_path / "a.stl").read_bytes() == (tmp_path / "b.stl").read_bytes()
    assert (tmp_path / "a.stl").read_bytes() != (tmp_path / "c.stl").read_bytes()


@pytest.mark.parametrize("method", ["digs", "steik", "sal", "hash-grid"])
def test_fields_of_every_kind_come_back_from_their_checkpoints(method, cloud, tmp_path):
    kept = str(tmp_path / "run")
    words = ["--method", method, "--steps", "30", *SMALL, "--quiet", "--sharp", "off"]
    assert main(["fit", str(cloud), "-o", str(tmp_path / "a.stl"), "--run", kept, *words]) == 0
    again = ["mesh", kept, "-o", str(tmp_path / "b.stl"), "--resolution", "24"]
    assert main(again) == 0
    assert (tmp_path / "a.stl").read_bytes() == (tmp_path / "b.stl").read_bytes()


@pytest.mark.slow
def test_killed_at_random_steps_and_resumed_gives_the_same_mesh(finished, cloud, tmp_path):
    """Five runs, each killed at a random step by signal 9 and resumed; test_kill has every write."""
    rng = np.random.default_rng(0)
    expected = (finished[0] / "part.stl").read_bytes()
    for trial in range(5):
        words = ["fit", cloud, "-o", tmp_path / f"{trial}.stl", "--run", tmp_path / f"run{trial}"]
        words += ["--steps", 60, *SMALL]
        process = Started(*words)
        last = rng.integers(1, 20)
        for line in process.stderr:
            last -= line.startswith("step ")
            if last <= 0:
                break
        process.kill()
        process.communicate()
        assert process.returncode == -signal.SIGKILL
        code, _, err = run(*words, "--resume", "--quiet")
        assert code == 0, err
        assert (tmp_path / f"{trial}.stl").read_bytes() == expected
        kept = [steps_kept(folder / "history") for folder in (finished[0] / "run", tmp_path / f"run{trial}")]
        assert kept[0] == kept[1]


@pytest.mark.parametrize("keeps", [True, False])
def test_interrupt_leaves_checkpoint_mesh_and_advice(finished, cloud, tmp_path, keeps):
    words = ["fit", cloud, "-o", tmp_path / "part.stl", "--steps", 60, *SMALL]
    process = Started(*words, *(["--run", tmp_path / "part.run"] if keeps else []))
    for line in process.stderr:
        if line.startswith("step 30/"):
            process.send_signal(signal.SIGINT)
            break
    _, err = process.communicate()
    assert process.returncode == 130
    assert "go on with" in err
    assert "--resume" in err
    assert topology(read_mesh(tmp_path / "part.stl")).watertight
    summary = json.loads((tmp_path / "part.run" / "summary.json").read_text())
    assert summary["finished"] is False
    assert 30 <= summary["steps"] < 60
    code, _, err = run(*words, "--run", tmp_path / "part.run", "--resume")
    assert code == 0, err
    assert (tmp_path / "part.stl").read_bytes() == (finished[0] / "part.stl").read_bytes()


def write_rows(path: Path, rows: np.ndarray) -> Path:
    """Rows of numbers as text."""
    np.savetxt(path, rows)
    return path


def clouds() -> dict[str, np.ndarray]:
    """Arrays no part can be fitted to."""
    rng = np.random.default_rng(0)
    points = rng.random((1000, 3))
    spoilt = points.copy()
    spoilt[:50] = np.nan
    return {
        "few": points[:50],
        "identical": np.ones((1000, 3)),
        "collinear": points[:, :1] * [[1.0, 2.0, 3.0]],
        "coplanar": points * [[1.0, 1.0, 0.0]],
        "not finite": spoilt,
    }


@pytest.mark.parametrize("name", clouds())
def test_clouds_that_hold_no_part(name, tmp_path, capsys):
    path = write_rows(tmp_path / "cloud.xyz", clouds()[name])
    refused(["fit", path, "-o", tmp_path / "part.stl"], tmp_path, capsys)


def refused(words: list, folder: Path, capsys) -> str:
    """Check for exit code 2, one sentence, no traceback, an earlier output in place; return the sentence."""
    earlier = folder / "part.stl"
    earlier.write_text("earlier")
    assert main([str(word) for word in words]) == 2
    error = capsys.readouterr().err
    sentences = [line for line in error.splitlines() if line.startswith("weingarten ")]
    assert len(sentences) == 1
    assert sentences[0].endswith(".")
    assert "Traceback" not in error
    assert earlier.read_text() == "earlier"
    assert not temporaries(folder)
    return sentences[0]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--preset", "best"], "standard, fine, paper"),
        (["--method", "magic"], "odw-paper"),
        (["--schedule", "cubic"], "quintic"),
        (["--knots", "0:10,0.5"], "time:weight"),
        (["--knots", "0.5:1,0.2:1"], "order"),
        (["--knots", "0:1,1.5:1"], "[0, 1]"),
        (["--knots", "0:-1,1:0"], "negative"),
        (["--seed", "-1"], "--seed"),
        (["--steps", "0"], "--steps"),
        (["--rate", "0"], "--rate"),
        (["--rate", "nan"], "--rate"),
        (["--points-per-step", "0"], "--points-per-step"),
        (["--resolution", "2"], "--resolution"),
        (["--device", "gpu"], "auto"),
        (["--device", "cuda"], "cuda"),
        (["--resume"], "--run"),
    ],
)
def test_options_out_of_range(options, said, cloud, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("torch.cuda.is_available", lambda: False)
    assert said in refused(["fit", cloud, "-o", tmp_path / "part.stl", *options], tmp_path, capsys)


def test_files_that_cannot_be_read_or_written(cloud, tmp_path, capsys):
    part = tmp_path / "part.stl"
    assert "missing.ply" in refused(["fit", tmp_path / "missing.ply", "-o", part], tmp_path, capsys)
    (tmp_path / "empty.ply").touch()
    assert "empty.ply" in refused(["fit", tmp_path / "empty.ply", "-o", part], tmp_path, capsys)
    (tmp_path / "cut.ply").write_bytes(cloud.read_bytes()[:5000])
    assert "cut.ply" in refused(["fit", tmp_path / "cut.ply", "-o", part], tmp_path, capsys)
    assert "part.step" in refused(["fit", cloud, "-o", tmp_path / "part.step"], tmp_path, capsys)
    assert "nowhere" in refused(["fit", cloud, "-o", tmp_path / "nowhere" / "part.stl"], tmp_path, capsys)
    picture = ["--picture", tmp_path / "nowhere" / "part.png"]
    assert "nowhere" in refused(["fit", cloud, "-o", part, *picture], tmp_path, capsys)


def test_checkpoints_that_do_not_fit(finished, cloud, tmp_path, capsys):
    part, folder = tmp_path / "part.stl", tmp_path / "run"
    words = ["fit", cloud, "-o", part, "--run", folder, "--resume", "--steps", 60, *SMALL]
    assert "no checkpoint" in refused(words, tmp_path, capsys)
    for name in ("checkpoint.safetensors", "cloud.npy", "loss.csv"):
        (folder / name).write_bytes((finished[0] / "run" / name).read_bytes())
    assert "seed" in refused([*words, "--seed", 1], tmp_path, capsys)
    other = write_rows(tmp_path / "other.xyz", sample_part("bracket", 4000, 0))
    assert "another cloud" in refused([words[0], other, *words[2:]], tmp_path, capsys)
    for damaged in (b"not a checkpoint", (folder / "checkpoint.safetensors").read_bytes()[:1000]):
        (folder / "checkpoint.safetensors").write_bytes(damaged)
        assert "corrupted" in refused(words, tmp_path, capsys)
        assert "corrupted" in refused(["mesh", folder, "-o", part], tmp_path, capsys)
    assert "no run folder" in refused(["mesh", tmp_path / "none", "-o", part], tmp_path, capsys)


def test_few_bad_rows_and_duplicates_are_said_and_survived(cloud, tmp_path):
    points = read_points(cloud)
    spoilt = np.concatenate([points, points[:100], np.full((5, 3), np.nan)])
    path = write_rows(tmp_path / "cloud.csv", spoilt)
    code, out, err = run("fit", path, "-o", tmp_path / "part.ply", "--json", "--steps", 20, *SMALL)
    assert code == 0
    notes = json.loads(out)["summary"]["notes"]
    assert any("not finite" in note for note in notes)
    assert any("merged" in note for note in notes)
    assert sum(line.startswith("Note:") for line in err.splitlines()) >= 2


def test_oracle_stops_early_and_keeps_the_best(cloud, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("weingarten.oracle.EVERY", 10)
    monkeypatch.setattr("weingarten.oracle.PATIENCE", 10)
    monkeypatch.setattr("weingarten.oracle.RESOLUTION", 32)
    chamfers = iter([3.0, 1.0, 2.0])
    monkeypatch.setattr("weingarten.oracle.Oracle.chamfer", lambda *_: next(chamfers))
    words = ["fit", str(cloud), "-o", str(tmp_path / "part.stl"), "--run", str(tmp_path / "run"), "--json"]
    assert main([*words, "--oracle", "bundled:flange", "--steps", "100", *SMALL]) == 0
    summary = json.loads(capsys.readouterr().out)["summary"]
    assert summary["steps"] == 30
    assert summary["finished"] is True
    again = ["mesh", str(tmp_path / "run"), "-o", str(tmp_path / "again.stl")]
    assert main(again) == 0
    assert (tmp_path / "again.stl").read_bytes() == (tmp_path / "part.stl").read_bytes()


def test_an_oracle_looks_at_the_finished_field_too(cloud, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("weingarten.oracle.EVERY", 10)
    looked = []
    look = lambda _, loop, __: looked.append(loop.step) or 1.0  # noqa: E731
    monkeypatch.setattr("weingarten.oracle.Oracle.chamfer", look)
    words = ["fit", str(cloud), "-o", str(tmp_path / "part.stl"), "--oracle", "bundled:flange", "--quiet"]
    assert main([*words, "--steps", "25", *SMALL, "--sharp", "off"]) == 0
    assert looked == [10, 20, 25]


def test_doctor_says_what_there_is(monkeypatch, capsys):
    for name, settings in PRESETS.items():
        monkeypatch.setitem(PRESETS, name, replace(settings, points=150, width=32))
    assert main(["doctor", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {"standard", "fine", "paper"} == set(found["presets"])
    assert found["versions"]["torch"] != "MISSING"
    assert all(cost["seconds"] > 0 for cost in found["presets"].values())


def test_help_is_one_screen_and_needs_no_torch():
    code, out, _ = run_anew("--help")
    assert code == 0
    assert len(out.splitlines()) < 40
    probe = "import sys; import weingarten.cli.main as m; m.parser(); print('torch' in sys.modules)"
    import subprocess

    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"

"""The verbs sample and evaluate, through the command's own parser."""

import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from weingarten.cli import evaluate, sample
from weingarten.errors import InputError, OptionError, OutputError
from weingarten.io.points import read_points


def command(*words: str) -> int:
    """The two verbs under a parser of their own, so that the others need not exist."""
    root = argparse.ArgumentParser()
    verbs = root.add_subparsers()
    for verb in (sample, evaluate):
        verb.add(verbs, argparse.ArgumentDefaultsHelpFormatter)
    arguments = root.parse_args([str(word) for word in words])
    return arguments.run(arguments)


@pytest.fixture
def box(tmp_path: Path) -> Path:
    path = tmp_path / "box.stl"
    trimesh.creation.box((4, 2, 1)).export(path)
    return path


def test_sample_of_a_file(tmp_path: Path, box: Path, capsys: pytest.CaptureFixture[str]):
    assert command("sample", box, "-o", tmp_path / "scan.ply", "--points", "1234") == 0
    points = read_points(tmp_path / "scan.ply")
    assert points.shape == (1234, 3)
    np.testing.assert_allclose((np.abs(points) / [2, 1, 0.5]).max(axis=1), 1, rtol=1e-9)
    assert "1,234 points" in capsys.readouterr().out


def test_sample_of_a_bundled_part_with_noise_and_outliers(tmp_path: Path):
    clean, dirty = tmp_path / "clean.npy", tmp_path / "dirty.npy"
    common = ("sample", "bundled:bracket", "--points", "2000", "--seed", "4", "-o")
    assert command(*common, clean) == 0
    assert command(*common, dirty, "--noise", "0.05", "--outliers", "0.1") == 0
    moved = np.linalg.norm(np.load(dirty) - np.load(clean), axis=1)
    assert (moved > 0.5).sum() == pytest.approx(200, abs=10)
    assert np.median(moved) == pytest.approx(0.05 * 1.54, rel=0.15)


def test_sample_with_what_a_scanner_misses(tmp_path: Path, box: Path):
    """From two places opposite each other some faces of a box are seen; the ball leaves a hole in them."""
    options = ("--points", "3000", "--views", "2", "--missing", "0.2", "--uneven", "5", "--noise", "0.001")
    assert command("sample", box, "-o", tmp_path / "scan.npy", *options) == 0
    points = np.load(tmp_path / "scan.npy")
    assert points.shape == (3000, 3)
    np.testing.assert_allclose((np.abs(points) / [2, 1, 0.5]).max(axis=1), 1, atol=0.02)
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 21)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    top = np.column_stack([grid * [1.95, 0.95], np.full(len(grid), 0.5)])
    gaps = [np.linalg.norm(points - side * top[:, None], axis=-1).min(axis=1).max() for side in (1, -1)]
    assert max(gaps) > 0.5


@pytest.mark.parametrize(
    "options",
    [
        ("--points", "0"),
        ("--seed", "-1"),
        ("--noise", "-0.1"),
        ("--noise", "nan"),
        ("--outliers", "1"),
        ("--outliers", "-0.1"),
        ("--uneven", "0.5"),
        ("--missing", "1"),
        ("--views", "0"),
    ],
)
def test_impossible_options_name_themselves(tmp_path: Path, box: Path, options: tuple[str, str]):
    with pytest.raises(OptionError, match=options[0]):
        command("sample", box, "-o", tmp_path / "scan.ply", *options)
    assert not (tmp_path / "scan.ply").exists()


def test_missing_mesh_unknown_part_and_unknown_format(tmp_path: Path, box: Path):
    with pytest.raises(InputError, match=r"none\.stl"):
        command("sample", tmp_path / "none.stl", "-o", tmp_path / "scan.ply")
    with pytest.raises(OptionError, match="gear"):
        command("sample", "bundled:gear", "-o", tmp_path / "scan.ply")
    with pytest.raises(OutputError, match=r"scan\.las"):
        command("sample", box, "-o", tmp_path / "scan.las")


def test_evaluate_prints_the_protocol_and_units(box: Path, capsys: pytest.CaptureFixture[str]):
    assert command("evaluate", box, box) == 0
    text = capsys.readouterr().out
    assert text.startswith("protocol exact-1\n")
    assert "unit-cube lengths" in text
    assert "genus, mesh" in text


@pytest.mark.parametrize(("name", "version"), [("exact", "exact-1"), ("published", "published-1")])
def test_evaluate_as_json(box: Path, capsys: pytest.CaptureFixture[str], name: str, version: str):
    assert command("evaluate", box, box, "--protocol", name, "--json", "--seed", "2") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["protocol"] == version
    assert 0.99 < found["normal_consistency"] <= 1 + 1e-9
    assert 0 <= found["chamfer"] < 0.004


def test_evaluate_of_an_open_mesh_says_that_it_has_no_genus(tmp_path: Path, box: Path, capsys):
    whole = trimesh.creation.box((4, 2, 1))
    trimesh.Trimesh(whole.vertices, whole.faces[1:]).export(tmp_path / "open.stl")
    assert command("evaluate", tmp_path / "open.stl", box, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["watertight"], found["genus"], found["truth_genus"]) == (False, None, 0)


def test_importing_the_verbs_imports_nothing_heavy():
    program = (
        "import sys; from weingarten.cli import sample, evaluate;"
        "print([m for m in ('numpy', 'torch', 'scipy', 'trimesh', 'igl', 'PIL') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_whole_command_gives_code_2_and_one_sentence(tmp_path: Path):
    pytest.importorskip("weingarten.cli.main", reason="not every verb is there yet", exc_type=ImportError)
    program = "import sys; from weingarten.cli.main import main; sys.exit(main())"
    words = ["evaluate", str(tmp_path / "a.stl"), str(tmp_path / "b.stl")]
    done = subprocess.run(
        [sys.executable, "-c", program, *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stderr.startswith("weingarten evaluate: ")
    assert len(done.stderr.splitlines()) == 1

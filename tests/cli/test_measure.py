"""`weingarten measure`: the files and the JSON of a small fit, and what it says to those who err."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from weingarten.calculus.exact import Sphere
from weingarten.cli.main import main
from weingarten.io.mesh import read_mesh
from weingarten.reconstruction import reconstruct
from weingarten.samples.parts import Part, sample_solid
from weingarten.settings import resolve

CENTRE, RADIUS = (100.0, -20.0, 5.0), 3.0
BALL = Part(Sphere(CENTRE, RADIUS), CENTRE, (RADIUS, RADIUS, RADIUS), 0, "a ball")


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """The folder of a small fit of a ball, with a network that begins as one."""
    folder = tmp_path_factory.mktemp("measured") / "ball.run"
    settings = resolve(method="igr", steps=40, points=300, resolution=32)
    reconstruct(sample_solid(BALL, 4000, 0), settings, device="cpu", run_folder=folder)
    return folder


def command(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    """Exit code, standard output, standard error."""
    capsys.readouterr()
    code = main(["measure", *map(str, words)])
    return code, *capsys.readouterr()


def test_a_ball_is_a_sphere_in_json_table_and_files(run, tmp_path, capsys):
    code, out, err = command(capsys, run, "--json", "-o", tmp_path / "copy.json")
    assert (code, err) == (0, "")
    found = json.loads(out)
    (ball,) = found["primitives"]
    assert (ball["number"], ball["kind"], ball["side"]) == (0, "sphere", "boss")
    assert ball["radius"] == pytest.approx(RADIUS, rel=1e-6)
    np.testing.assert_allclose(ball["position"], CENTRE, atol=1e-5)
    assert ball["coverage"] > 0.85
    assert found["free_form"]["share"] < 0.15
    assert json.loads((run / "primitives.json").read_text()) == found
    assert json.loads((tmp_path / "copy.json").read_text()) == found
    labels = np.load(run / "labels.npy")
    assert labels.dtype == np.int32
    assert labels.shape == (len(read_mesh(run / "mesh.ply").vertices),)
    assert set(labels.tolist()) <= {-1, 0}
    _, table, _ = command(capsys, run)
    assert "sphere" in table
    assert "R 3.00" in table


def test_no_run_folder(tmp_path, capsys):
    code, out, err = command(capsys, tmp_path / "none.run")
    assert (code, out) == (2, "")
    assert "There is no run folder" in err


def test_a_run_without_a_mesh(run, tmp_path, capsys):
    folder = shutil.copytree(run, tmp_path / "bare.run")
    (folder / "mesh.ply").unlink()
    code, out, err = command(capsys, folder)
    assert (code, out) == (2, "")
    assert "has no mesh yet" in err
    assert not list(folder.glob(".*"))


def test_a_place_that_cannot_be_written(run, tmp_path, capsys):
    code, out, err = command(capsys, run, "-o", tmp_path / "nowhere" / "x.json")
    assert (code, out) == (2, "")
    assert "does not exist" in err

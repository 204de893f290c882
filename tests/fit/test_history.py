"""Snapshots of a fit: at the same steps whether it is resumed or not, and without effect on its mesh."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import torch
from jaxtyping import Float64

import weingarten as wg
from weingarten.errors import CheckpointError
from weingarten.fit import history
from weingarten.fit.history import FOLDER, planned, steps_kept, weights
from weingarten.fit.loop import Record
from weingarten.fit.run_folder import RunFolder
from weingarten.methods import METHODS
from weingarten.observer import Observer

SHORT = {"method": "odw", "steps": 24, "points": 100, "resolution": 24, "sharp": False}


class Impatient(Observer):
    """Stops after some steps."""

    def __init__(self, steps: int) -> None:
        self.left = steps

    def step(self, record: Record, steps: int, seconds: float) -> None:
        self.left -= 1

    def interrupted(self) -> bool:
        return self.left <= 0


@pytest.fixture(scope="module")
def ball() -> Float64[np.ndarray, "n 3"]:
    directions = np.random.default_rng(0).normal(size=(600, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True) + 4.0


@pytest.fixture(scope="module")
def whole(ball, tmp_path_factory) -> tuple[Path, wg.Result]:
    folder = tmp_path_factory.mktemp("whole") / "run"
    return folder, wg.reconstruct(ball, wg.resolve(**SHORT), run_folder=folder)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / FOLDER).iterdir()}


def test_snapshots_are_close_at_first_and_reach_from_start_to_end(make_loop):
    loop = make_loop(METHODS["odw-paper"], width=16, depth=3, steps=950)
    steps = planned(loop)
    assert (steps[0], steps[-1], len(steps)) == (0, 950, history.SNAPSHOTS)
    assert (np.diff(np.diff(steps)) >= -1).all()
    assert planned(loop, 0) == []
    assert planned(make_loop(METHODS["odw-paper"], width=16, depth=3, steps=3)) == [0, 1, 2, 3]


def test_large_fields_have_few_snapshots_or_none(make_loop, monkeypatch):
    loop = make_loop(METHODS["odw-paper"], width=16, depth=3)
    size = sum(4 * value.numel() for value in loop.field.state_dict().values())
    monkeypatch.setattr(history, "BYTES", 5 * size)
    assert planned(loop) == [0, 25, 71, 130, 200]
    monkeypatch.setattr(history, "BYTES", size)
    assert planned(loop) == []


def test_a_fit_keeps_its_first_and_its_last_field(whole):
    folder, result = whole
    assert steps_kept(folder / FOLDER)[::99] == [0]
    assert steps_kept(folder / FOLDER)[-1] == SHORT["steps"]
    last, first = (weights(folder / FOLDER, step) for step in (SHORT["steps"], 0))
    for name, value in result.field.module.state_dict().items():
        assert torch.equal(last[name], value)
        assert first[name].shape == value.shape
    assert any(not torch.equal(first[name], last[name]) for name in first)


def test_the_mesh_is_the_same_with_and_without(ball, whole):
    mesh = wg.reconstruct(ball, wg.resolve(**SHORT)).mesh
    np.testing.assert_array_equal(mesh.vertices, whole[1].mesh.vertices)
    np.testing.assert_array_equal(mesh.faces, whole[1].mesh.faces)


def test_a_resumed_fit_has_the_snapshots_of_an_uninterrupted_one(ball, whole, tmp_path):
    settings, run = wg.resolve(**SHORT), tmp_path / "run"
    wg.reconstruct(ball, settings, run_folder=run, observer=Impatient(9))
    assert steps_kept(run / FOLDER) == [step for step in steps_kept(whole[0] / FOLDER) if step <= 9]
    (run / FOLDER / "0000023.safetensors").write_bytes(b"of steps that were lost")
    (run / FOLDER / ".0000010-abcdefgh.safetensors").write_bytes(b"left by a kill")
    wg.reconstruct(ball, settings, run_folder=run, resume=True)
    assert contents(run) == contents(whole[0])
    assert (run / "mesh.ply").read_bytes() == (whole[0] / "mesh.ply").read_bytes()


def test_another_fit_in_the_folder_begins_without_those_of_the_first(ball, whole, tmp_path):
    run = Path(shutil.copytree(whole[0], tmp_path / "run"))
    keeper = RunFolder(run, snapshots=0)
    keeper.begin(keeper.found().origin, ball, None)
    assert steps_kept(run / FOLDER) == []
    assert not (run / "summary.json").exists()


def test_what_is_no_snapshot_is_said(whole, tmp_path):
    with pytest.raises(CheckpointError, match="no snapshot"):
        weights(whole[0] / FOLDER, 7)
    (tmp_path / "0000007.safetensors").write_bytes(b"nothing of the kind")
    with pytest.raises(CheckpointError, match="cannot be read"):
        weights(tmp_path, 7)

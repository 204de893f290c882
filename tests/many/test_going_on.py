"""A reconstruction in a folder goes on from whatever an interruption has left there."""

import csv
from pathlib import Path

import numpy as np
import pytest

from weingarten.fit import checkpoint
from weingarten.fit.run_folder import RunFolder
from weingarten.many.going_on import gone_on, seconds_of
from weingarten.observer import Observer
from weingarten.reconstruction import Result
from weingarten.samples.parts import sample_part
from weingarten.settings import resolve

SHORT = resolve(steps=12, points=60, resolution=24, sharp=False)


class Puller(Observer):
    """Pulls the plug after a step."""

    def __init__(self, after: int) -> None:
        self.after = after

    def step(self, record, steps, seconds) -> None:
        if record.step == self.after:
            raise KeyboardInterrupt


def made(path: Path, observer: Observer | None = None) -> tuple[Result, float]:
    return gone_on(sample_part("block", 1000, 0), SHORT, "cpu", RunFolder(path), observer=observer)


def steps(path: Path) -> list[int]:
    with (path / "loss.csv").open(newline="") as stream:
        return [int(row["step"]) for row in csv.DictReader(stream)]


@pytest.fixture(scope="module")
def straight(tmp_path_factory) -> Result:
    result, earlier = made(tmp_path_factory.mktemp("straight"))
    assert earlier == 0.0
    return result


@pytest.mark.parametrize("every", [0.0, 1e9])
def test_the_same_mesh_and_curve_after_an_interruption(tmp_path, straight, monkeypatch, every):
    """Checkpoints after every step, and none but the first one."""
    monkeypatch.setattr("weingarten.reconstruction.CHECKPOINT_SECONDS", every)
    with pytest.raises(KeyboardInterrupt):
        made(tmp_path, Puller(7))
    if every > 0:  # as when it is killed between the curve's last rows and the checkpoint
        (tmp_path / "loss.csv").write_text("step,progress,rate,loss,seconds,a\n0,0,0,0,0,0\n")
    assert checkpoint.load(tmp_path / "checkpoint.safetensors").step == (7 if every == 0 else 0)
    result, earlier = made(tmp_path)
    assert earlier > 0 or every > 0
    assert steps(tmp_path) == list(range(12))
    np.testing.assert_array_equal(result.mesh.vertices, straight.mesh.vertices)


def test_what_does_not_fit_is_begun_anew(tmp_path, straight):
    RunFolder(tmp_path).checkpoint.write_bytes(b"nothing")
    result, earlier = made(tmp_path)
    assert earlier == 0.0
    np.testing.assert_array_equal(result.mesh.vertices, straight.mesh.vertices)


def test_seconds_of_a_curve(tmp_path):
    assert seconds_of(tmp_path / "none.csv") == 0.0
    (tmp_path / "loss.csv").write_text("step,seconds\n0,0.5\n1,0.25\n2,\n")
    assert seconds_of(tmp_path / "loss.csv") == 0.75

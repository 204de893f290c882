"""What a run folder keeps, and what goes when another fit begins in it."""

import json
from pathlib import Path

import numpy as np
import pytest

from weingarten.fit.checkpoint import Origin, fingerprint
from weingarten.fit.run_folder import RESULTS, RunFolder
from weingarten.frame import Frame
from weingarten.settings import resolve

POINTS = np.random.default_rng(0).normal(size=(20, 3))
ORIGIN = Origin(resolve(), Frame.of(POINTS), fingerprint(POINTS), (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), 2.2)


@pytest.fixture
def used(tmp_path: Path) -> Path:
    """A folder that an earlier fit has left, with a file of the user's own."""
    for name in (*RESULTS, "notes.txt"):
        (tmp_path / name).write_text("of an earlier fit")
    return tmp_path


def test_a_new_fit_takes_away_the_results_of_another(used: Path):
    RunFolder(used).begin(ORIGIN, POINTS, None)
    assert sorted(path.name for path in used.iterdir()) == [
        "cloud.npy",
        "config.toml",
        "history",
        "loss.csv",
        "notes.txt",
    ]


def test_the_record_is_written_before_the_first_step(used: Path):
    RunFolder(used, {"command": "weingarten fit a.ply"}).begin(ORIGIN, POINTS, None)
    assert json.loads((used / "made.json").read_text()) == {"command": "weingarten fit a.ply"}

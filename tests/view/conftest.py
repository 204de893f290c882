"""A run of the bundled flange, small and unfinished in shape, shared by all tests of the view."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
import exhibits

from weingarten.view import run


@pytest.fixture(autouse=True)
def coarse(monkeypatch) -> None:
    """Surfaces on the way are made of few cells."""
    monkeypatch.setattr(run, "RESOLUTION", 40)


@pytest.fixture(scope="session")
def run_folder(tmp_path_factory) -> Path:
    """Nobody writes to it; copy it to do so."""
    return exhibits.run(tmp_path_factory.mktemp("viewed") / "part.run")

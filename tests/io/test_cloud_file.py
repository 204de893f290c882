"""Clouds come back from every format to the last bit."""

from pathlib import Path

import numpy as np
import pytest

from weingarten.errors import OutputError
from weingarten.io import cloud_file
from weingarten.io.cloud_file import FORMATS, write_cloud
from weingarten.io.points import read_points


@pytest.mark.parametrize("suffix", [*FORMATS, ".PLY", ".Csv"])
def test_round_trip_is_exact(tmp_path: Path, suffix: str):
    points = np.random.default_rng(0).normal(size=(200, 3)) * [1e-5, 1, 1e5] + 1e6
    path = tmp_path / f"scan{suffix}"
    write_cloud(path, points)
    assert np.array_equal(read_points(path), points)
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("suffix", [".xyz", ".csv"])
def test_blocks_of_text_are_the_text_of_the_whole(tmp_path: Path, suffix: str, monkeypatch):
    points = np.random.default_rng(0).normal(size=(200, 3))
    write_cloud(tmp_path / f"whole{suffix}", points)
    monkeypatch.setattr(cloud_file, "BLOCK", 7)
    write_cloud(tmp_path / f"blocks{suffix}", points)
    assert (tmp_path / f"blocks{suffix}").read_bytes() == (tmp_path / f"whole{suffix}").read_bytes()


@pytest.mark.parametrize("name", ["scan.stl", "scan", "missing/scan.ply"])
def test_impossible_place_is_an_error(tmp_path: Path, name: str):
    with pytest.raises(OutputError):
        write_cloud(tmp_path / name, np.zeros((1, 3)))

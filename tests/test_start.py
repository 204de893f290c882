"""What a fit begins with: all points of a usual cloud, and so many of a large one that more cost nothing."""

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree

from weingarten import start as module
from weingarten.fit.checkpoint import fingerprint
from weingarten.frame import Frame
from weingarten.samples.parts import sample_part
from weingarten.scan import draws, thinning
from weingarten.settings import resolve
from weingarten.start import MARGIN, REACH, Start

CPU = torch.device("cpu")


@pytest.fixture(scope="module")
def cloud() -> np.ndarray:
    return sample_part("flange", 3000, 0)


@pytest.fixture
def sizes(monkeypatch) -> dict[str, list[int]]:
    """How many points trees were made of, and how many were asked for their neighbours."""
    found: dict[str, list[int]] = {"tree": [], "neighbours": []}
    ask = draws.neighbour_distance

    def tree(points, **options):
        found["tree"].append(len(points))
        return KDTree(points, **options)

    def neighbours(tree, points, neighbour):
        found["neighbours"].append(len(points))
        return ask(tree, points, neighbour)

    monkeypatch.setattr(module, "KDTree", tree)
    monkeypatch.setattr(draws, "neighbour_distance", neighbours)
    return found


def test_a_usual_cloud_is_drawn_from_as_a_whole(cloud, sizes):
    start = Start.of(cloud, resolve(), CPU)
    np.testing.assert_array_equal(start.unit, start.frame.to_unit(cloud))
    assert sizes == {"tree": [3000], "neighbours": [3000]}
    assert not any("draws from" in note for note in start.notes)


def test_of_a_large_cloud_a_part_is_drawn_from_and_said(cloud, sizes, monkeypatch):
    monkeypatch.setattr(thinning, "MOST_POINTS", 800)
    start = Start.of(cloud, resolve(seed=5), CPU)
    assert sizes == {"tree": [800], "neighbours": [800]}
    assert len(start.draws.points) == len(start.draws.sigma) == len(start.unit) == 800
    np.testing.assert_array_equal(start.unit, start.frame.to_unit(thinning.thinned(cloud, 5)))
    assert sum("800 of the 3,000 points" in note for note in start.notes) == 1
    again = Start.of(cloud, resolve(seed=5), CPU)
    assert torch.equal(again.draws.pool, start.draws.pool)


def test_frame_box_and_fingerprint_are_those_of_all_points(cloud, monkeypatch):
    whole = Start.of(cloud, resolve(), CPU)
    monkeypatch.setattr(thinning, "MOST_POINTS", 200)
    start = Start.of(cloud, resolve(), CPU)
    assert start.cloud is cloud
    assert start.frame == Frame.of(cloud)
    assert start.origin == whole.origin
    assert start.origin.fingerprint == fingerprint(cloud)


def test_the_surface_is_looked_for_in_the_box_of_the_points_and_the_margin(cloud):
    origin = Start.of(cloud, resolve(), CPU).origin
    unit = origin.frame.to_unit(cloud)
    np.testing.assert_array_equal(origin.lower, np.maximum(unit.min(axis=0) - MARGIN, -REACH))
    np.testing.assert_array_equal(origin.upper, np.minimum(unit.max(axis=0) + MARGIN, REACH))

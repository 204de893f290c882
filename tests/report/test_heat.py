"""Colours of distances: the scale's end and ticks, and distances of what is seen against closed forms."""

import numpy as np
import pytest
import trimesh

from weingarten.mesh import Mesh
from weingarten.metrics.distance import Nearby
from weingarten.report.camera import Camera
from weingarten.report.heat import ANCHORS, Scale, colour_map, scale_for, seen_distances
from weingarten.report.panel import seen

BOX = trimesh.creation.box((1, 1, 1))
MESH = Mesh(np.array(BOX.vertices), np.array(BOX.faces, dtype=np.int64))


def test_the_colour_map_gets_ever_darker_from_the_first_anchor_to_the_last():
    colours = colour_map().astype(float)
    light = colours @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(light) < 0.5).all()
    assert light[0] - light[-1] > 150
    for anchor, colour in ((ANCHORS[0], colours[0]), (ANCHORS[-1], colours[-1])):
        assert [int(anchor[k : k + 2], 16) for k in (1, 3, 5)] == colour.tolist()


def test_levels_are_linear_and_end_at_the_end():
    scale = Scale(2.0)
    assert scale.places(np.array([0.0, 1.0, 2.0, 50.0])).tolist() == [0, 127.5, 255, 255]
    assert np.array_equal(scale.colours(np.array([9.0])), colour_map()[-1:] / 255)


@pytest.mark.parametrize(
    ("end", "texts", "unit"),
    [
        (2.0, ["0", "0.5", "1", "1.5", "≥ 2"], "in the unit of the file"),
        (0.0002, ["0", "50", "100", "150", "≥ 200"], "in 10⁻⁶ of the unit of the file"),
        (0.005, ["0", "1.25", "2.5", "3.75", "≥ 5"], "in 10⁻³ of the unit of the file"),
        (50_000.0, ["0", "12.5", "25", "37.5", "≥ 50"], "in 10³ of the unit of the file"),
    ],
)
def test_ticks_are_short_numbers(end: float, texts: list[str], unit: str):
    scale = Scale(end)
    assert [text for _, text in scale.ticks()] == texts
    assert [place for place, _ in scale.ticks()] == [0, 0.25, 0.5, 0.75, 1]
    assert scale.unit == unit


@pytest.mark.parametrize(
    ("values", "end"), [([0.0], 0.1), ([0.3], 0.5), ([0.5], 0.5), ([0.3, 0.9, 70], 1), ([99], 2), ([], 0.1)]
)
def test_the_scale_takes_in_the_contender_in_the_middle_within_limits(values: list[float], end: float):
    """In a part whose longest side is 100: from 0.1 to 2."""
    assert scale_for(100.0, [np.full(5, float(value)) for value in values]).end == pytest.approx(end)


def test_distances_of_what_is_seen_of_a_shifted_box():
    """Moved up by ¼, the top is ¼ from the truth and the sides are 0 to ¼."""
    moved = Mesh(MESH.vertices + np.array([0, 0, 0.25]), MESH.faces)
    panel = seen(moved, Camera.around(MESH.vertices, 80))
    distance = seen_distances(panel, Nearby(MESH))
    height = panel.positions[:, 2] - 0.5
    assert len(distance) == len(panel.face) == panel.seen.sum()
    coarse = 2.5 / panel.camera.scale  # one place stands for its block
    assert np.abs(distance - np.maximum(height, 0)).max() < coarse
    assert distance.max() == pytest.approx(0.25)


def test_nothing_seen_has_no_distances():
    camera = Camera.around(MESH.vertices, 20)
    away = seen(Mesh(MESH.vertices + 1e3, MESH.faces), camera)
    assert seen_distances(away, Nearby(MESH)).shape == (0,)

"""Contours are closed, wound outward and near the true surface, whatever the field, at a sparse cost."""

import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.calculus.exact import Box, CappedCylinder, Cylinder, Difference, Sphere, Torus, Union
from weingarten.errors import ExtractionError, OptionError
from weingarten.surface import octree
from weingarten.surface.contour import extract, extraction

sys.path.insert(0, str(Path(__file__).parent))
from closed import assert_closed, solid

LOWER, UPPER = np.full(3, -1.1), np.full(3, 1.1)
SPHERE = Sphere(centre=(0.03, -0.02, 0.01), radius=0.9)
TORUS = Torus(axis=(1.0, 2.0, 3.0), ring=0.7, tube=0.25)
CYLINDER = CappedCylinder(axis=(1.0, 2.0, 3.0), radius=0.4, half_height=0.8)
BOX = Box(half=(0.81, 0.72, 0.63))
PART = Union((Difference(BOX, CappedCylinder(radius=0.3)), Torus(axis=(1.0, 0.0, 0.0), ring=0.65, tube=0.2)))


@pytest.mark.parametrize(
    ("shape", "euler", "volume"),
    [
        (SPHERE, 2, 4 / 3 * np.pi * 0.9**3),
        (TORUS, 0, 2 * np.pi**2 * 0.7 * 0.25**2),
        (BOX, 2, 8 * 0.81 * 0.72 * 0.63),
        (CYLINDER, 2, np.pi * 0.4**2 * 1.6),
    ],
)
def test_exact_shapes(shape, euler, volume):
    mesh = extract(shape, LOWER, UPPER, 96)
    assert_closed(mesh)
    assert solid(mesh).euler_number == euler
    assert solid(mesh).volume == pytest.approx(volume, rel=0.01)


@pytest.mark.parametrize("shape", [SPHERE, TORUS])
def test_vertex_error_falls_with_the_square_of_the_cell(shape):
    worst = []
    for resolution in (32, 64, 128):
        vertices = extract(shape, LOWER, UPPER, resolution).vertices
        worst.append(float(shape(torch.from_numpy(vertices)).abs().max()))
    assert worst[1] < worst[0] / 3
    assert worst[2] < worst[1] / 3


@pytest.mark.parametrize("resolution", [70, 100])
def test_sparse_equals_dense(resolution, monkeypatch):
    sparse = extraction(PART, LOWER, UPPER, resolution)
    monkeypatch.setattr(octree, "COARSE_CELLS", 10**6)
    dense = extraction(PART, LOWER, UPPER, resolution)
    assert sparse.evaluations < 0.4 * dense.evaluations
    assert len(sparse.mesh.faces) == len(dense.mesh.faces)
    rows = [np.unique(np.round(e.mesh.vertices, 12), axis=0) for e in (sparse, dense)]
    np.testing.assert_allclose(rows[0], rows[1], atol=1e-9)


@pytest.mark.parametrize("resolution", [20, 40, 80])
def test_faces_in_lattice_planes(resolution):
    mesh = extract(Box(half=(0.5, 0.5, 0.5)), np.full(3, -1.0), np.full(3, 1.0), resolution)
    assert_closed(mesh)
    assert solid(mesh).euler_number == 2
    assert solid(mesh).volume == pytest.approx(1.0, rel=0.06)


def test_zero_on_nodes_counts_as_outside():
    mesh = extract(Box(half=(0.5, 0.5, 0.5)), np.full(3, -1.0), np.full(3, 1.0), 16)
    step = 2.0 / 16
    assert np.abs(mesh.vertices).max() < 0.5
    # a vertex keeps a thousandth of an edge from its nodes, lest single precision merge two
    assert np.abs(mesh.vertices).max() == pytest.approx(0.5 - 1e-3 * step, abs=1e-5)


def test_resolution_counts_along_the_longest_side():
    plate = Box(half=(1.0, 1.0, 0.02))
    found = extraction(plate, np.array([-1.1, -1.1, -0.12]), np.array([1.1, 1.1, 0.12]), 128)
    assert_closed(found.mesh)
    step = np.unique(np.round(found.mesh.vertices[np.abs(found.mesh.vertices[:, 2]) > 0.0199, 0], 9))
    assert np.diff(step).min() == pytest.approx(2.2 / 128, rel=1e-3)
    assert solid(found.mesh).volume == pytest.approx(0.16, rel=0.02)
    assert found.evaluations < 150_000


def test_a_plate_between_coarse_nodes_is_found():
    mesh = extract(Box(half=(1.0, 1.0, 0.006), centre=(0.0, 0.0, 0.05)), LOWER, UPPER, 256)
    assert_closed(mesh)
    assert solid(mesh).euler_number == 2
    np.testing.assert_allclose(mesh.bounds[:, 2], [0.044, 0.056], atol=1e-3)


def test_two_components():
    pair = Union((Sphere((-0.5, 0.0, 0.0), 0.3), Sphere((0.5, 0.1, 0.0), 0.2)))
    mesh = extract(pair, LOWER, UPPER, 64)
    assert_closed(mesh)
    assert solid(mesh).euler_number == 4
    assert solid(mesh).body_count == 2


def test_a_surface_that_leaves_the_box_is_closed_at_its_sides():
    found = extraction(Cylinder(radius=0.5), LOWER, UPPER, 64)
    assert_closed(found.mesh)
    assert solid(found.mesh).volume == pytest.approx(np.pi * 0.25 * 2.2, rel=0.01)
    side = 1.1 - 1e-3 * 2.2 / 64
    np.testing.assert_allclose(found.mesh.bounds[:, 2], [-side, side], atol=1e-6)
    assert len(found.notes) == 1
    assert extraction(Cylinder(radius=0.06), LOWER, UPPER, 128).notes
    assert not extraction(SPHERE, LOWER, UPPER, 64).notes


@pytest.mark.parametrize("sides", [(2.2, 1.3, 0.7), (0.31, 2.0, 2.0)])
def test_sides_that_are_no_multiple_of_the_cell(sides):
    mesh = extract(Sphere(radius=3.0), np.zeros(3), np.array(sides) + 2.0, 70)
    assert_closed(mesh)
    assert solid(mesh).volume > 0


@pytest.mark.parametrize(
    "field",
    [
        lambda p: 3.0 * SPHERE(p),
        lambda p: 0.01 * SPHERE(p),
        lambda p: SPHERE(p) * (1.0 + 0.5 * torch.sin(9.0 * p.sum(dim=1))),
        lambda p: torch.tanh(5.0 * SPHERE(p)),
    ],
)
def test_gradients_of_any_scale(field):
    found = extraction(field, LOWER, UPPER, 128)
    assert_closed(found.mesh)
    assert solid(found.mesh).euler_number == 2
    assert solid(found.mesh).volume == pytest.approx(4 / 3 * np.pi * 0.9**3, rel=2e-3)
    assert found.evaluations < 0.12 * 129**3


@pytest.mark.parametrize(("resolution", "shift", "seed"), [(24, 0, 0), (24, 0, 1), (24, -1, 2), (66, 1.5, 3)])
def test_white_noise_is_closed(resolution, shift, seed):
    """Independent values at the nodes: every ambiguous case occurs, and no bound on the gradient holds."""
    lower, upper = np.zeros(3), np.full(3, float(resolution))
    side = resolution + 1
    table = torch.from_numpy(np.random.default_rng(seed).normal(shift, size=(side,) * 3))

    def noise(points):
        i, j, k = points.round().long().clamp(0, side - 1).unbind(dim=1)
        return table[i, j, k].float()

    mesh = extract(noise, lower, upper, resolution)
    assert_closed(mesh)
    assert solid(mesh).volume > 0


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 2**31), st.floats(2.0, 25.0), st.sampled_from([12, 33, 66]))
def test_smooth_noise_is_closed(seed, frequency, resolution):
    draw = np.random.default_rng(seed)
    waves = torch.from_numpy(draw.normal(size=(3, 12)) * frequency).float()
    phases = torch.from_numpy(draw.uniform(0, 2 * np.pi, 12)).float()
    mesh = extract(lambda p: torch.sin(p @ waves + phases).sum(dim=1), LOWER, UPPER, resolution)
    assert_closed(mesh)


@pytest.mark.parametrize("resolution", [40, 160])
@pytest.mark.parametrize("value", [1.0, -1.0, 0.0, float("nan")])
def test_no_surface(value, resolution):
    with pytest.raises(ExtractionError):
        extract(lambda p: torch.full((len(p),), value), LOWER, UPPER, resolution)


@pytest.mark.parametrize(("upper", "resolution"), [(LOWER, 64), (UPPER, 1)])
def test_impossible_requests(upper, resolution):
    with pytest.raises(OptionError):
        extract(SPHERE, LOWER, upper, resolution)


def test_cost_is_that_of_the_surface():
    calls = []

    def counted(points):
        calls.append(len(points))
        return SPHERE(points)

    found = extraction(counted, LOWER, UPPER, 256, batch=4096)
    assert sum(calls) == found.evaluations
    assert max(calls) <= 4096
    assert found.evaluations < 0.03 * 257**3
    assert found.evaluations < 2.2 * len(found.mesh.vertices)


def test_the_same_twice():
    first, second = (extract(PART, LOWER, UPPER, 70) for _ in range(2))
    assert np.array_equal(first.vertices, second.vertices)
    assert np.array_equal(first.faces, second.faces)

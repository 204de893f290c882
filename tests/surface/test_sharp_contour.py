"""Vertices on sharp edges: exact shapes, shapes that are rounded off, and the topology of marching cubes."""

import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.calculus.exact import Box, CappedCylinder, Difference, Sphere, Torus
from weingarten.crew import Crew
from weingarten.surface.contour import extraction
from weingarten.surface.planes import REACH, Planes
from weingarten.surface.sharp_contour import SharpContour
from weingarten.surface.values import field_planes

sys.path.insert(0, str(Path(__file__).parent))
from closed import assert_closed, solid

LOWER, UPPER = np.full(3, -1.1), np.full(3, 1.1)
HALF = (0.81, 0.72, 0.63)
BOX = Box(half=HALF)
DRILLED = Difference(BOX, CappedCylinder(radius=0.3))


class Field(torch.nn.Module):
    """An exact shape, blown up by some length, as a module that lives somewhere."""

    def __init__(self, shape, round_by=0.0):
        super().__init__()
        self.shape, self.round_by = shape, round_by
        self.register_parameter("here", torch.nn.Parameter(torch.zeros(())))

    def forward(self, points):
        return self.shape(points) - self.round_by


def rounded(radius):
    """BOX with its edges rounded off."""
    return Field(Box(half=tuple(half - radius for half in HALF)), radius)


def sharp(field, resolution):
    mesher = SharpContour(field_planes(field, Crew()))
    with torch.no_grad():
        return extraction(field, LOWER, UPPER, resolution, mesher=mesher).mesh


def distances(mesh, shape):
    return shape(torch.from_numpy(mesh.vertices)).abs().numpy()


@pytest.mark.parametrize(("shape", "euler"), [(BOX, 2), (DRILLED, 0)])
@pytest.mark.parametrize("resolution", [33, 64])
def test_sharp_edges_are_kept(shape, euler, resolution):
    field = Field(shape)
    mesh = sharp(field, resolution)
    plain = extraction(field, LOWER, UPPER, resolution).mesh
    assert_closed(mesh)
    assert solid(mesh).euler_number == euler
    true = 8 * np.prod(HALF) - (euler == 0) * np.pi * 0.09 * 2 * HALF[2]
    assert abs(solid(mesh).volume - true) < 0.2 * abs(solid(plain).volume - true)


def from_corners(mesh):
    """How far the nearest vertex is from each corner of BOX."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * HALF
    return np.array([np.linalg.norm(mesh.vertices - corner, axis=1).min() for corner in corners])


def test_a_box_comes_back_to_its_corners():
    mesh = sharp(Field(BOX), 40)
    assert distances(mesh, BOX).max() < 1e-5
    assert from_corners(mesh).max() < 1e-5
    assert solid(mesh).volume == pytest.approx(8 * np.prod(HALF), rel=1e-5)


@pytest.mark.parametrize("radius", [0.006, 0.012])
def test_what_a_field_rounds_off_is_put_back(radius):
    field = rounded(radius)
    mesh = sharp(field, 220)
    plain = extraction(field, LOWER, UPPER, 220).mesh
    assert_closed(mesh)
    lost = 8 * np.prod(HALF) - np.array([solid(mesh).volume, solid(plain).volume])
    assert abs(lost[0]) < 0.25 * lost[1]
    assert from_corners(mesh).max() < 0.3 * from_corners(plain).min()


@pytest.mark.parametrize("shape", [Sphere(radius=0.3), Torus(ring=0.6, tube=0.1), Sphere(radius=0.06)])
def test_smooth_shapes_stay_as_they_are(shape):
    mesh = sharp(Field(shape), 128)
    assert_closed(mesh)
    assert distances(mesh, shape).max() < 1e-3
    assert distances(mesh, shape).mean() < 2e-4


def flat(points):
    """Planes that tell nothing, all of one normal."""
    return Planes(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)), np.zeros(len(points)))


def assert_same_topology(values, resolution, lower=LOWER, upper=UPPER):
    mesh = extraction(values, lower, upper, resolution, mesher=SharpContour(flat)).mesh
    plain = extraction(values, lower, upper, resolution).mesh
    assert_closed(mesh)
    assert solid(mesh).euler_number == solid(plain).euler_number
    assert len(solid(mesh).split(only_watertight=False)) == len(solid(plain).split(only_watertight=False))


@pytest.mark.parametrize(("shift", "seed"), [(0, 0), (0, 1), (-1, 2), (1.0, 3)])
def test_white_noise_has_the_topology_of_marching_cubes(shift, seed):
    """Every ambiguous case occurs, and edges that would have four faces."""
    table = torch.from_numpy(np.random.default_rng(seed).normal(shift, size=(17, 17, 17)))

    def noise(points):
        i, j, k = points.round().long().clamp(0, 16).unbind(dim=1)
        return table[i, j, k].float()

    assert_same_topology(noise, 16, np.zeros(3), np.full(3, 16.0))


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 2**31), st.floats(2.0, 25.0), st.sampled_from([12, 33]))
def test_smooth_noise_has_the_topology_of_marching_cubes(seed, frequency, resolution):
    draw = np.random.default_rng(seed)
    waves = torch.from_numpy(draw.normal(size=(3, 12)) * frequency).float()
    phases = torch.from_numpy(draw.uniform(0, 2 * np.pi, 12)).float()
    assert_same_topology(lambda p: torch.sin(p @ waves + phases).sum(dim=1), resolution)


def test_no_vertex_is_further_from_its_cell_than_allowed():
    field = rounded(0.02)
    mesh = sharp(field, 60)
    assert distances(mesh, lambda p: field(p.float())).max() < 1.5 * 2.2 / 60 + REACH

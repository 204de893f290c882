"""Bundled parts: samples on the exact surface and uniform, meshes closed and of the designed genus."""

import math

import numpy as np
import pytest
import torch

from weingarten.calculus.exact import Box, CappedCylinder, Cone, Plane, Shape, Sphere, Torus
from weingarten.errors import OptionError
from weingarten.metrics.distance import closest
from weingarten.metrics.topology import topology
from weingarten.samples.parts import PARTS, part, part_mesh, sample_part
from weingarten.samples.patches import patches

AXIS = (1.0, 2.0, -2.0)


@pytest.mark.parametrize("name", PARTS)
def test_samples_lie_on_the_exact_surface_and_fill_the_box(name: str):
    points = sample_part(name, 8000, 0)
    assert points.shape == (8000, 3)
    assert PARTS[name].solid(torch.from_numpy(points)).abs().max() < 1e-8
    reach = np.abs(points - PARTS[name].centre).max(axis=0)
    assert (reach <= np.array(PARTS[name].half) + 1e-9).all()
    np.testing.assert_allclose(reach, PARTS[name].half, rtol=0.02)


@pytest.mark.parametrize("name", PARTS)
def test_mesh_is_closed_has_the_designed_genus_and_the_samples_lie_on_it(name: str):
    mesh = part_mesh(name, 64)
    found = topology(mesh)
    assert (found.watertight, found.oriented, found.components) == (True, True, 1)
    assert found.genus == PARTS[name].genus
    assert found.volume > 0
    distance = closest(mesh, sample_part(name, 3000, 1)).distance
    cell = 2 * max(PARTS[name].half) / 64
    assert distance.max() < cell
    assert np.median(distance) < 0.02 * cell


def test_flange_is_sampled_by_area():
    """Shares of the underside, the bore and the rim against their areas."""
    points = sample_part("flange", 20_000, 0)
    x, y, z = (points - [210.0, -95.0, 60.0]).T
    rho = np.hypot(x, y)
    underside = math.pi * (40**2 - 11**2 - 6 * 4**2)
    bore, rim = 2 * math.pi * 11 * 28, 2 * math.pi * 40 * 10
    disc_top = math.pi * (40**2 - 20**2 - 6 * 4**2)
    hub = math.pi * (20**2 - 11**2) + 2 * math.pi * 20 * 18
    total = underside + bore + rim + disc_top + hub + 6 * 2 * math.pi * 4 * 10
    assert (np.abs(z) < 1e-6).mean() == pytest.approx(underside / total, abs=0.01)
    assert (np.abs(rho - 11) < 1e-6).mean() == pytest.approx(bore / total, abs=0.01)
    assert (np.abs(rho - 40) < 1e-6).mean() == pytest.approx(rim / total, abs=0.01)


def test_faces_shared_by_two_primitives_are_not_sampled_twice():
    """The bracket's side y = 0 belongs to base and wall: uniform over their union."""
    points = sample_part("bracket", 40_000, 0) - [-140.0, 75.0, 20.0]
    side = points[np.abs(points[:, 1]) < 1e-6]
    shared = ((side[:, 0] < 8) & (side[:, 2] < 8)).mean()
    assert shared == pytest.approx(64 / (80 * 8 + 8 * 52), abs=0.01)


def test_seed_decides_and_count_is_exact():
    assert np.array_equal(sample_part("block", 500, 1), sample_part("block", 500, 1))
    assert not np.array_equal(sample_part("block", 500, 1), sample_part("block", 500, 2))
    assert len(sample_part("block", 1, 0)) == 1


def test_unknown_part_is_an_error_that_lists_the_known():
    with pytest.raises(OptionError, match="flange, bracket, block"):
        part("gear")


@pytest.mark.parametrize(
    ("shape", "area"),
    [
        (Box((1.0, 2.0, 3.0), (1.0, 2.0, 3.0)), 8 * (2 + 3 + 6)),
        (CappedCylinder((1.0, 2.0, 3.0), AXIS, 2.0, 3.0), 2 * math.pi * 2 * 6 + 2 * math.pi * 4),
        (Sphere((1.0, 2.0, 3.0), 2.0), 16 * math.pi),
        (Torus((1.0, 2.0, 3.0), AXIS, 3.0, 1.0), 4 * math.pi**2 * 3),
        (Plane((1.0, 2.0, 3.0), AXIS), math.pi * 25),
        (Cone((1.0, 2.0, 3.0), AXIS, math.pi / 6), math.pi / 2 * 25),
    ],
)
def test_patches_cover_the_primitive(shape: Shape, area: float):
    pieces = patches(shape, np.array([1.0, 2, 3]), 5.0)
    assert sum(piece.area for piece in pieces) == pytest.approx(area)
    random = np.random.default_rng(0)
    points = np.concatenate([piece.draw(random, 500) for piece in pieces])
    assert shape(torch.from_numpy(points)).abs().max() < 1e-12


def test_torus_patch_is_uniform_by_area():
    """The outer half holds ½ + r/(πR) of the area."""
    points = patches(Torus(ring=3.0, tube=1.0), np.zeros(3), 5.0)[0].draw(np.random.default_rng(0), 100_000)
    outer = np.hypot(points[:, 0], points[:, 1]) > 3
    assert outer.mean() == pytest.approx(0.5 + 1 / (3 * math.pi), abs=0.006)

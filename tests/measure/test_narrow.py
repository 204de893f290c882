"""Planes narrower than the spacing of the points, where the field's normals tell nothing."""

import numpy as np
import pytest

from weingarten.measure.axis import Axis
from weingarten.measure.cylinder import Cylinder
from weingarten.measure.growing import Region
from weingarten.measure.narrow import flattened, narrow_planes
from weingarten.measure.plane import Plane
from weingarten.measure.skin import Skin
from weingarten.measure.torus import Torus

SPACING, TOLERANCE = 0.01, 0.001
UP = np.array([0.0, 0.0, 1.0])
TUBE = Cylinder(Axis(np.array([0.0, 0.0, -0.3]), np.array([1.0, 0.0, 0.0])), 0.1)


def skin_of(points: np.ndarray, noise: float = 0.0) -> Skin:
    """Points that the field says nothing of: their normals are any, and none has a neighbour."""
    normals = np.random.default_rng(1).normal(size=points.shape)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    flat, alone = np.zeros((len(points), 2)), np.arange(len(points))[:, None]
    return Skin(points, points, normals, flat, alone, noise, SPACING, np.zeros(len(points)))


def rim(count: int, height: float) -> np.ndarray:
    """Points of the rim of a square tray, half a spacing wide and three spacings from one to the next."""
    rng = np.random.default_rng(0)
    along, across = rng.uniform(-0.4, 0.4, count), 0.4 + rng.uniform(0.0, 0.5 * SPACING, count)
    x, y = np.where(rng.integers(0, 2, count) == 0, (along, across), (across, along))
    signs = rng.choice([-1.0, 1.0], (2, count))
    return np.column_stack([signs[0] * x, signs[1] * y, np.full(count, height)])


def cap(count: int) -> np.ndarray:
    """Points of a free-form surface, far below: a bowl of sixty spacings' radius."""
    x, y = np.random.default_rng(2).uniform(-0.2, 0.2, (2, count))
    return np.column_stack([x, y, -0.5 + (x**2 + 0.5 * y**2) / 1.2 + 0.1 * x**3])


def wall(count: int) -> np.ndarray:
    """Points of the tube."""
    angles, height = np.random.default_rng(5).uniform(0, 2 * np.pi, count), np.linspace(-0.3, 0.3, count)
    return np.column_stack([height, 0.1 * np.cos(angles), -0.3 + 0.1 * np.sin(angles)])


def disc(count: int, centre: tuple[float, float, float]) -> np.ndarray:
    """Points of the bottom of a hole of two spacings' radius."""
    rng = np.random.default_rng(3)
    away, angle = 2 * SPACING * np.sqrt(rng.uniform(size=count)), rng.uniform(0, 2 * np.pi, count)
    return np.array(centre) + np.column_stack([away * np.cos(angle), away * np.sin(angle), np.zeros(count)])


def test_a_rim_and_bottoms_are_found_and_free_form_is_not():
    parts = rim(160, 0.3), cap(1600), disc(14, (0.0, 0.0, 0.1)), disc(11, (0.2, 0.2, 0.1))
    skin = skin_of(np.concatenate(parts))
    starts = np.cumsum([0, *map(len, parts)])
    found = sorted(narrow_planes([], skin, TOLERANCE), key=lambda region: -len(region.members))
    assert [len(region.members) for region in found] == [160, 14]
    for region, number in zip(found, (0, 2), strict=True):
        np.testing.assert_array_equal(region.members, np.arange(starts[number], starts[number + 1]))
        np.testing.assert_allclose(np.abs(region.surface.normals(skin.points[:1])), [UP], atol=1e-9)
        assert np.abs(region.surface.distance(skin.points[region.members])).max() < 1e-12


def test_points_of_regions_are_left_to_them():
    points = np.concatenate([rim(160, 0.3), rim(160, 0.35)])
    taken = Region(Plane(np.array([0.0, 0.0, 0.3]), UP), np.arange(160), 160.0)
    (found,) = narrow_planes([taken], skin_of(points), TOLERANCE)
    np.testing.assert_array_equal(found.members, np.arange(160, 320))
    assert narrow_planes([taken, found], skin_of(points), TOLERANCE) == []


@pytest.mark.parametrize(("shake", "sizes"), [(0.04, [160]), (0.1, []), (1.0, [])])
def test_points_about_a_plane_are_not_on_it(shake: float, sizes: list[int]):
    """Shares of the tolerance; so little noise is not told from none, and would make planes of its slabs."""
    points = rim(160, 0.3)
    points[:, 2] += np.random.default_rng(4).uniform(-1.0, 1.0, 160) * shake * TOLERANCE
    found = narrow_planes([], skin_of(points), TOLERANCE)
    assert [len(region.members) for region in found] == sizes


def test_nothing_is_told_where_points_are_noisy():
    skin = skin_of(rim(160, 0.3), noise=1e-3)
    bent = Region(Torus(Axis(np.zeros(3), UP), 2.0, 0.5), np.arange(160), 1.0)
    assert narrow_planes([], skin, TOLERANCE) == []
    assert flattened([bent], skin, TOLERANCE) == [bent]


def test_a_bent_surface_whose_points_are_on_a_plane_becomes_it():
    skin = skin_of(np.concatenate([rim(160, 0.3), wall(300)]))
    bent = Region(Torus(Axis(np.zeros(3), UP), 2.0, 0.5), np.arange(160), 1.0)
    round_one = Region(TUBE, np.arange(160, 460), 300.0)
    flat = Region(Plane(np.array([0.0, 0.0, 0.3]), UP), np.arange(160), 160.0)
    made = flattened([bent, round_one, flat], skin, TOLERANCE)
    assert isinstance(made[0].surface, Plane)
    assert len(made[0].members) == 160
    assert made[1:] == [round_one, flat]


def test_a_tube_that_has_taken_points_of_a_plane_stays_one():
    mixed = Region(TUBE, np.arange(320), 300.0)
    assert flattened([mixed], skin_of(np.concatenate([rim(160, 0.3), wall(160)])), TOLERANCE) == [mixed]

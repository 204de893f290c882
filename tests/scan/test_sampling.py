"""Samples lie on the surface, uniform by area, and repeat with the seed."""

import numpy as np
import pytest
import trimesh

from weingarten.errors import InputError, OptionError
from weingarten.mesh import Mesh
from weingarten.scan.sampling import corrupt, sample_surface

SHAPE = trimesh.creation.box((4, 2, 1))
BOX = Mesh(np.array(SHAPE.vertices, dtype=np.float64), np.array(SHAPE.faces, dtype=np.int64))


def test_points_lie_on_their_faces():
    points, faces = sample_surface(BOX, 5000, 0)
    assert points.dtype == np.float64
    assert points.shape == (5000, 3)
    a, b, c = BOX.corners[faces].transpose(1, 0, 2)
    parts = [np.linalg.norm(np.cross(u - points, v - points), axis=1) for u, v in ((a, b), (b, c), (c, a))]
    np.testing.assert_allclose(0.5 * sum(parts), BOX.areas[faces], rtol=1e-9)


def test_faces_are_drawn_by_area():
    _, faces = sample_surface(BOX, 100_000, 1)
    share = np.bincount(faces, minlength=len(BOX.faces)) / 100_000
    np.testing.assert_allclose(share, BOX.areas / BOX.areas.sum(), atol=0.005)


def test_uniform_within_a_triangle():
    """Each of the four triangles that the edge middles cut off gets a quarter; the mean is the centroid."""
    one = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    points, _ = sample_surface(one, 40_000, 2)
    x, y, z = points.T
    assert not z.any()
    for inside in (x > 0.5, y > 0.5, x + y < 0.5):
        assert inside.mean() == pytest.approx(0.25, abs=0.01)
    assert (x.mean(), y.mean()) == pytest.approx((1 / 3, 1 / 3), abs=0.005)


def test_seed_decides():
    first, second, third = (sample_surface(BOX, 100, seed)[0] for seed in (5, 5, 6))
    assert np.array_equal(first, second)
    assert not np.array_equal(first, third)


def test_degenerate_faces_get_no_points():
    mesh = Mesh(BOX.vertices, np.concatenate([[[0, 0, 1]], BOX.faces, [[2, 2, 2]]]))
    faces = sample_surface(mesh, 2000, 0)[1]
    assert faces.min() > 0
    assert faces.max() < len(mesh.faces) - 1


@pytest.mark.parametrize("faces", [np.empty((0, 3), dtype=np.int64), np.array([[0, 1, 1]])])
def test_no_surface_is_an_error(faces: np.ndarray):
    with pytest.raises(InputError, match="no surface"):
        sample_surface(Mesh(np.eye(3), faces), 10, 0)


def test_noise_has_its_standard_deviation_and_leaves_the_input_alone():
    clean = np.random.default_rng(0).uniform(size=(50_000, 3))
    kept = clean.copy()
    assert (corrupt(clean, 0.02, 0.0, 0) - clean).std() == pytest.approx(0.02, rel=0.02)
    assert np.array_equal(clean, kept)
    assert np.array_equal(corrupt(clean, 0.0, 0.0, 0), clean)


def test_outliers_are_counted_and_fill_the_enlarged_box():
    clean = sample_surface(BOX, 40_000, 0)[0] + 100
    dirty = corrupt(clean, 0.0, 0.5, 0)
    moved = (dirty != clean).any(axis=1)
    assert moved.sum() == 20_000
    half = 1.1 * np.array([2, 1, 0.5])
    reach = np.abs(dirty[moved] - 100).max(axis=0)
    assert (reach <= half + 1e-3).all()
    np.testing.assert_allclose(reach, half, rtol=0.01)


@pytest.mark.parametrize(
    ("noise", "outliers"), [(-1.0, 0.0), (np.nan, 0.0), (np.inf, 0.0), (0.0, 1.0), (0.0, -0.1), (0.0, np.nan)]
)
def test_impossible_corruption_is_an_error(noise: float, outliers: float):
    with pytest.raises(OptionError):
        corrupt(np.zeros((3, 3)), noise, outliers, 0)

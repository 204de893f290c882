"""Normals of neighbourhoods: planes exactly, and how flat a neighbourhood is."""

import numpy as np
import pytest

from weingarten.scan.normals import plane_normals


def patches(heights, seed=0):
    """Twelve points each over a unit square, turned by a random rotation; the rotations' third columns."""
    random = np.random.default_rng(seed)
    turns = np.linalg.qr(random.normal(size=(len(heights), 3, 3)))[0]
    flat = random.uniform(-1.0, 1.0, (len(heights), 12, 3))
    flat[:, :, 2] *= np.asarray(heights)[:, None]
    return flat @ turns.transpose(0, 2, 1), turns[:, :, 2]


def test_a_plane_has_its_normal_and_is_flat():
    points, expected = patches(np.zeros(50))
    normals, flatness = plane_normals(points + 3.0)
    np.testing.assert_allclose(np.abs((normals * expected).sum(1)), 1.0, atol=1e-12)
    assert flatness.max() < 1e-12


def test_flatness_grows_with_the_height_and_is_at_most_one():
    medians = [np.median(plane_normals(patches(np.full(200, height))[0])[1]) for height in (0.05, 0.2, 1.0)]
    assert medians == sorted(medians)
    assert medians[0] < 0.01
    assert medians[-1] > 0.3
    assert plane_normals(patches(np.full(200, 1.0))[0])[1].max() <= 1.0


def test_points_that_coincide_have_no_normal_to_trust():
    normals, flatness = plane_normals(np.ones((1, 12, 3)))
    assert np.isfinite(normals).all()
    assert np.isfinite(flatness).all()


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_the_scale_does_not_matter(scale):
    points, _ = patches(np.full(20, 0.3))
    one, other = plane_normals(points), plane_normals(scale * points)
    np.testing.assert_allclose(np.abs((one[0] * other[0]).sum(1)), 1.0, atol=1e-9)
    np.testing.assert_allclose(one[1], other[1], rtol=1e-9)

"""Points beside an edge have the plane of their side, with the field's sign; those of no plane have none."""

import numpy as np

from weingarten.surface.cloud_planes import cloud_planes
from weingarten.surface.planes import Planes


def rounded_cube(points):
    """The planes of a cube of half side 1 that a field has rounded a little."""
    power = points**9
    normals = power / np.linalg.norm(power, axis=1, keepdims=True)
    return Planes(points, normals, np.zeros(len(points)))


def cube(count):
    random = np.random.default_rng(0)
    points = random.uniform(-1.0, 1.0, (count, 3))
    axis, side = random.integers(0, 3, count), random.choice([-1.0, 1.0], count)
    points[np.arange(count), axis] = side
    return points


def test_they_are_the_faces_outward():
    points = cube(6000)
    found = cloud_planes(points, rounded_cube)
    assert len(found.points) > 0.8 * len(points)
    square = np.abs(found.normals).max(axis=1)
    assert (square > 0.999).mean() > 0.99
    assert ((found.normals * found.points).sum(axis=1) > 0.95).all()


def test_a_field_that_disagrees_has_the_last_word():
    def aslant(points):
        return Planes(
            points, np.tile(np.sqrt([1 / 3, 1 / 3, 1 / 3]), (len(points), 1)), np.zeros(len(points))
        )

    assert len(cloud_planes(cube(3000), aslant).points) < 30


def test_a_cloud_without_planes_has_none():
    points = np.random.default_rng(1).normal(size=(3000, 3))
    outward = Planes(points, points / np.linalg.norm(points, axis=1, keepdims=True), np.zeros(len(points)))
    assert len(cloud_planes(points, lambda _: outward).points) < 60

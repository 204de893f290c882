"""Beside an edge and in a thin wall a point has the plane that it lies in, and on an edge it has none."""

import numpy as np
import pytest
from scipy.spatial import KDTree
from trimesh.creation import box
from trimesh.sample import sample_surface

from weingarten.scan.facets import Facets, facets
from weingarten.scan.orientation import NEIGHBOURS, OTHERS, flat_normals


def neighbours(points):
    reach, near = KDTree(points).query(points, k=OTHERS + 1)
    return reach[:, -1], near[:, 1:]


def cube(count, size=(2.0, 2.0, 2.0), seed=0):
    """Points on a box with the normals of their faces, and their distances from the nearest edge."""
    solid = box(size)
    points, faces = sample_surface(solid, count, seed=np.random.default_rng(seed))
    points, normals = np.asarray(points), solid.face_normals[faces]
    inset = np.sort(np.asarray(size) / 2 - np.abs(points), axis=1)
    return points, normals, inset[:, 1]


def degrees(found, normals):
    return np.degrees(np.arccos(np.clip(np.abs((found * normals).sum(1)), 0.0, 1.0)))


def test_a_plane_has_its_normal_and_all_trust():
    points = np.random.default_rng(0).uniform(-1, 1, (2000, 3)) * np.array([1.0, 1.0, 0.0])
    found = facets(points, neighbours(points)[1])
    np.testing.assert_allclose(np.abs(found.normals[:, 2]), 1.0)
    assert (found.trust == 1.0).mean() > 0.99


def test_beside_an_edge_it_is_right_where_least_squares_are_not():
    points, normals, inset = cube(20_000)
    reach, near = neighbours(points)
    beside = (inset < 0.7 * reach) & (inset > 0.15 * reach)
    plane, _ = flat_normals(points[near[:, :NEIGHBOURS]])
    found = facets(points, near)
    assert (degrees(plane, normals)[beside] > 10).mean() > 0.3
    trusted = beside & (found.trust > 0.5)
    assert trusted.sum() > 0.7 * beside.sum()
    assert (degrees(found.normals, normals)[trusted] < 1.0).mean() > 0.98


def test_on_an_edge_there_is_little_trust():
    points, _, inset = cube(20_000)
    reach, near = neighbours(points)
    trust = facets(points, near).trust
    assert trust[inset < 0.01 * reach].mean() < 0.5 * trust[inset > reach].mean()


def test_the_faces_of_a_wall_thinner_than_the_spacing_are_told_apart():
    points, normals, inset = cube(8_000, (2.0, 2.0, 0.02))
    reach, near = neighbours(points)
    within = inset > reach
    assert np.median(reach) > 2 * 0.02
    found = facets(points, near)
    assert (found.trust[within] > 0.5).mean() > 0.8
    assert np.quantile(degrees(found.normals, normals)[within & (found.trust > 0.5)], 0.99) < 1.0


@pytest.mark.parametrize("scatter", [0.5, 1.0])
def test_points_in_no_plane_have_no_trust(scatter):
    points = np.random.default_rng(0).normal(size=(4000, 3)) * np.array([1.0, 1.0, scatter])
    assert (facets(points, neighbours(points)[1]).trust > 0.5).mean() < 0.05


def test_it_turns_and_grows_with_the_points():
    points, _, _ = cube(1000)
    near = neighbours(points)[1]
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    one, other = facets(points, near), facets(1e3 * points @ turn.T, near)
    assert isinstance(other, Facets)
    np.testing.assert_allclose(np.abs((other.normals * (one.normals @ turn.T)).sum(1)), 1.0, atol=1e-6)
    np.testing.assert_allclose(other.trust, one.trust, atol=1e-6)

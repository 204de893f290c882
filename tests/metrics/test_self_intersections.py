"""Faces that pass through others are found, all of them and no others, against all pairs one by one."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from trimesh.creation import box

from weingarten.mesh import Mesh
from weingarten.metrics.self_intersections import self_intersecting
from weingarten.samples.parts import part_mesh


def segment_meets(p, q, corners):
    """Whether a segment crosses the inside of a triangle, by solving for where it meets its plane."""
    a, b, c = corners
    matrix = np.column_stack([b - a, c - a, p - q])
    if abs(np.linalg.det(matrix)) < 1e-12:
        return False
    s, t, u = np.linalg.solve(matrix, p - a)
    inside = s > 0 and t > 0 and s + t < 1
    return inside and 1e-9 < u < 1 - 1e-9  # an end that both have in common is no crossing


def by_all_pairs(mesh):
    """The slow way."""
    found = np.zeros(len(mesh.faces), dtype=bool)
    for one, other in itertools.combinations(range(len(mesh.faces)), 2):
        if len(np.intersect1d(mesh.faces[one], mesh.faces[other])) > 1:
            continue
        pairs = [(mesh.corners[one], mesh.corners[other]), (mesh.corners[other], mesh.corners[one])]
        if any(
            segment_meets(first[i], first[(i + 1) % 3], second) for first, second in pairs for i in range(3)
        ):
            found[[one, other]] = True
    return found


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("size", [0.1, 0.3])
def test_as_all_pairs_say(seed, size):
    random = np.random.default_rng(seed)
    corners = random.random((60, 1, 3)) + size * random.standard_normal((60, 3, 3))
    soup = Mesh(corners.reshape(-1, 3), np.arange(180).reshape(-1, 3))
    expected = by_all_pairs(soup)
    assert 0 < expected.sum() < 60
    np.testing.assert_array_equal(self_intersecting(soup), expected)


@pytest.mark.parametrize("seed", range(4))
def test_faces_with_common_corners(seed):
    random = np.random.default_rng(seed)
    faces = np.array([random.choice(25, 3, replace=False) for _ in range(40)])
    tangle = Mesh(random.random((25, 3)), faces)
    expected = by_all_pairs(tangle)
    assert expected.any()
    np.testing.assert_array_equal(self_intersecting(tangle), expected)


def test_a_proper_surface_has_none():
    assert not self_intersecting(part_mesh("flange", 64)).any()


@pytest.mark.parametrize("away", [0.0, 1e3])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("seed", range(3))
def test_faces_in_one_plane_have_none_whatever_rounding_makes_of_the_plane(seed, scale, away):
    flat = box((1.0, 1.0, 1.0))
    for _ in range(4):
        flat = flat.subdivide()
    turn = Rotation.random(rng=seed).as_matrix()
    vertices = scale * (np.asarray(flat.vertices) @ turn.T) + away * scale
    assert not self_intersecting(Mesh(vertices, np.asarray(flat.faces, dtype=np.int64))).any()


def test_two_parts_that_overlap_pass_through_each_other_where_they_meet():
    bracket = part_mesh("bracket", 48)
    moved = Mesh(bracket.vertices + np.array([1.3, 0.7, 0.9]), bracket.faces)
    both = Mesh(
        np.concatenate([bracket.vertices, moved.vertices]),
        np.concatenate([bracket.faces, moved.faces + len(bracket.vertices)]),
    )
    found = self_intersecting(both)
    assert found[: len(bracket.faces)].any()
    assert found[len(bracket.faces) :].any()
    assert found.mean() < 0.9


@pytest.mark.parametrize("count", [0, 1])
def test_no_pairs(count):
    mesh = Mesh(np.eye(3), np.arange(3).reshape(1, 3)[:count])
    np.testing.assert_array_equal(self_intersecting(mesh), np.zeros(count, dtype=bool))


def test_faces_without_extent():
    mesh = Mesh(np.zeros((3, 3)), np.array([[0, 1, 2], [0, 1, 2]]))
    assert not self_intersecting(mesh).any()


def test_a_large_face_among_small_ones_costs_little():
    """Across the whole of 8,000 small ones, aslant: in cells of their size it would reach into millions."""
    random = np.random.default_rng(0)
    corners = 1000 * random.random((8000, 1, 3)) + 0.1 * random.standard_normal((8000, 3, 3))
    wide = np.array([[[-1, -1, -1], [1001, 1001, 999], [1001, -1, 1001]]], dtype=float)
    soup = Mesh(np.concatenate([corners, wide]).reshape(-1, 3), np.arange(3 * 8001).reshape(-1, 3))
    found = self_intersecting(soup)
    pairs = [
        by_all_pairs(Mesh(soup.vertices[[*range(3 * i, 3 * i + 3), -3, -2, -1]], np.arange(6).reshape(2, 3)))
        for i in range(8000)
    ]
    np.testing.assert_array_equal(found[:-1], [pair[0] for pair in pairs])
    assert found[-1] == any(pair[0] for pair in pairs)

"""closest and inside against a slow reference, closed forms, and coordinates that eat digits."""

import numpy as np
import pytest
import trimesh

from weingarten.errors import InputError
from weingarten.mesh import Mesh
from weingarten.metrics.distance import Nearby, closest, cut, inside


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


def slow_distance(mesh: Mesh, point: np.ndarray) -> float:
    """Least distance over the triangles: to the plane where the foot is inside, to the edges otherwise."""
    best = np.inf
    for a, b, c in mesh.corners:
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        foot = point - normal * ((point - a) @ normal)
        corners = (a, b, c)
        pairs = [(corners[k], corners[(k + 1) % 3]) for k in range(3)]
        if all(np.cross(end - start, foot - start) @ normal >= 0 for start, end in pairs):
            best = min(best, abs((point - a) @ normal))
        for start, end in pairs:
            share = np.clip((point - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
            best = min(best, float(np.linalg.norm(point - start - share * (end - start))))
    return best


def test_agrees_with_the_slow_reference():
    random = np.random.default_rng(0)
    faces = np.stack([random.permutation(40)[:3] for _ in range(40)])
    mesh = Mesh(random.normal(size=(40, 3)), faces)
    points = 2 * random.normal(size=(60, 3))
    found = closest(mesh, points)
    np.testing.assert_allclose(found.distance, [slow_distance(mesh, p) for p in points], rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(points - found.position, axis=1), found.distance, rtol=1e-12)
    for face, position in zip(found.face, found.position, strict=True):
        one = Mesh(mesh.vertices, mesh.faces[face : face + 1])
        assert slow_distance(one, position) < 1e-12


@pytest.mark.parametrize("offset", [0.0, 1e6])
@pytest.mark.parametrize("size", [1e-5, 1.0, 1e4])
def test_box_distance_at_any_size_and_offset(offset: float, size: float):
    random = np.random.default_rng(1)
    box = as_mesh(trimesh.creation.box((1, 1, 1)))
    queries = random.uniform(-2, 2, (200, 3))
    excess = np.abs(queries) - 0.5
    outside = np.linalg.norm(np.maximum(excess, 0), axis=1)
    expected = size * np.where(excess.max(axis=1) > 0, outside, -excess.max(axis=1))
    placed = Mesh(box.vertices * size + offset, box.faces)
    found = closest(placed, queries * size + offset)
    rounding = 4 * np.spacing(offset + size)
    np.testing.assert_allclose(found.distance, expected, atol=rounding + 1e-13 * size)


def test_faces_without_area_and_unused_vertices_count_for_nothing():
    vertices = np.array(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 0, 0], [6, 0, 0], [7, 0, 0], [9, 9, 9]], dtype=float
    )
    mesh = Mesh(vertices, np.array([[3, 4, 5], [1, 1, 2], [0, 1, 2]]))
    found = closest(mesh, np.array([[6.0, 0, 0], [0.2, 0.2, 3.0]]))
    np.testing.assert_allclose(found.distance, [5, 3])
    assert found.face.tolist() == [2, 2]


@pytest.mark.parametrize("faces", [np.empty((0, 3), dtype=np.int64), np.array([[0, 1, 1]])])
def test_no_surface_is_an_error(faces: np.ndarray):
    with pytest.raises(InputError, match="no surface"):
        closest(Mesh(np.eye(3), faces), np.zeros((1, 3)))


def test_no_points_are_near_nothing():
    found = Nearby(as_mesh(trimesh.creation.box((1, 1, 1)))).closest(np.zeros((0, 3)))
    assert (len(found.distance), len(found.face), found.position.shape) == (0, 0, (0, 3))


@pytest.mark.parametrize("winding", [1, -1])
def test_inside_of_a_box_with_a_cavity(winding: int):
    random = np.random.default_rng(2)
    box = as_mesh(trimesh.creation.box((1, 1, 1)))
    faces = np.concatenate([box.faces, box.faces[:, ::-1] + len(box.vertices)])
    hollow = Mesh(np.concatenate([box.vertices, 0.5 * box.vertices]), faces[:, ::winding])
    queries = random.uniform(-0.7, 0.7, (5000, 3))
    reach = np.abs(queries).max(axis=1)
    np.testing.assert_array_equal(inside(hollow, queries), (reach < 0.5) & (reach > 0.25))


def test_a_cut_mesh_is_the_same_surface():
    random = np.random.default_rng(3)
    mesh = as_mesh(trimesh.creation.cylinder(1.0, 5.0, 40))
    fine = cut(mesh, 0.3)
    sides = np.linalg.norm(fine.corners - np.roll(fine.corners, 1, axis=1), axis=2)
    assert 0.15 < sides.max() <= 0.3
    np.testing.assert_allclose(fine.areas.sum(), mesh.areas.sum(), rtol=1e-12)
    queries = random.uniform(-3, 3, (500, 3))
    np.testing.assert_allclose(closest(fine, queries).distance, closest(mesh, queries).distance, atol=1e-12)
    np.testing.assert_array_equal(inside(fine, queries), inside(mesh, queries))
    assert cut(fine, 1.0).corners.tolist() == fine.corners.tolist()
    assert len(cut(Mesh(np.eye(3), np.empty((0, 3), dtype=np.int64)), 1.0).faces) == 0

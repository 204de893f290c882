"""Sharp edges of exact parts, and their distances against closed forms and a slow reference."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from weingarten.mesh import Mesh
from weingarten.metrics.edges import distance_to_edges, lengths, sample_edges, sharp_edges

TURN = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))[:3, :3]


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


BOX = as_mesh(trimesh.creation.box((1, 0.5, 0.25)))


def soup(mesh: Mesh) -> Mesh:
    return Mesh(mesh.corners.reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))


@pytest.mark.parametrize("shape", [BOX, soup(BOX), Mesh(BOX.vertices @ TURN.T + 5.0, BOX.faces)])
def test_a_box_has_its_twelve_edges_and_no_diagonal(shape):
    found = sharp_edges(shape)
    assert np.sort(lengths(found)) == pytest.approx([0.25] * 4 + [0.5] * 4 + [1.0] * 4)


@pytest.mark.parametrize(("sections", "expected"), [(96, 2 * 96), (8, 3 * 8)])
def test_a_cylinder_has_its_rims_and_no_generator_of_a_fine_one(sections, expected):
    assert len(sharp_edges(as_mesh(trimesh.creation.cylinder(1.0, 2.0, sections)))) == expected


def test_a_sphere_has_none():
    assert sharp_edges(as_mesh(trimesh.creation.icosphere(3))).shape == (0, 2, 3)


@given(st.floats(1.0, 179.0))
def test_the_angle_decides(degrees):
    """Two triangles that share an edge and are folded by so much, and their four border edges."""
    fold = np.radians(degrees)
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.0, -np.cos(fold), -np.sin(fold)]])
    mesh = Mesh(vertices, np.array([[0, 1, 2], [1, 0, 3]]))
    assert len(sharp_edges(mesh, np.radians(degrees - 0.5))) == 5
    assert len(sharp_edges(mesh, np.radians(degrees + 0.5))) == 4


def test_degenerate_faces_and_an_empty_mesh_have_none_of_their_own():
    faces = np.concatenate([BOX.faces, [[0, 0, 1], [2, 2, 2]]])
    assert len(sharp_edges(Mesh(BOX.vertices, faces))) == 12
    assert len(sharp_edges(Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)))) == 0


def test_an_edge_of_three_faces_is_sharp():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, -1, 0.1]], dtype=np.float64)
    mesh = Mesh(vertices, np.array([[0, 1, 2], [1, 0, 3], [1, 0, 4]]))
    assert len(sharp_edges(mesh)) == 1 + 2 * 3


def test_samples_are_uniform_by_length():
    edges = np.array([[[0, 0, 0], [3.0, 0, 0]], [[0, 5, 0], [1.0, 5, 0]]])
    drawn = sample_edges(edges, 40_000, 0)
    first = drawn[:, 1] == 0
    assert first.mean() == pytest.approx(0.75, abs=0.01)
    assert drawn[first, 0].mean() == pytest.approx(1.5, abs=0.03)
    assert np.histogram(drawn[first, 0], 6, (0, 3))[0] / first.sum() == pytest.approx([1 / 6] * 6, abs=0.01)


def test_distances_are_those_of_a_slow_reference():
    draw = np.random.default_rng(0)
    edges, points = draw.normal(size=(20, 2, 3)), draw.normal(size=(200, 3))
    a, b = edges[None, :, 0], edges[None, :, 1]
    t = ((points[:, None] - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1)
    nearest = a + t.clip(0, 1)[..., None] * (b - a)
    expected = np.linalg.norm(points[:, None] - nearest, axis=-1).min(axis=1)
    assert distance_to_edges(points, edges) == pytest.approx(expected, abs=1e-12)

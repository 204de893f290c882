"""Folds are laid flat, and nothing else is touched."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from trimesh.creation import box, icosphere

from weingarten.mesh import Mesh
from weingarten.metrics.self_intersections import self_intersecting
from weingarten.surface.folds import still_folded, unfolded


def mesh_of(shape):
    return Mesh(np.asarray(shape.vertices, dtype=np.float64), np.asarray(shape.faces, dtype=np.int64))


def fine_box():
    shape = box((1.0, 1.0, 1.0))
    for _ in range(4):
        shape = shape.subdivide()
    shape.merge_vertices()
    return mesh_of(shape)


def edge_of(mesh):
    return float(np.median(np.linalg.norm(mesh.corners[:, 1] - mesh.corners[:, 0], axis=1)))


def shoved(mesh, chosen, by):
    """Some vertices moved by so many edges, each towards a neighbour and past it."""
    vertices = mesh.vertices.copy()
    for vertex in chosen:
        face = mesh.faces[np.flatnonzero((mesh.faces == vertex).any(axis=1))[0]]
        other = face[face != vertex][0]
        way = mesh.vertices[other] - mesh.vertices[vertex]
        vertices[vertex] += by * edge_of(mesh) * way / np.linalg.norm(way)
    return Mesh(vertices, mesh.faces)


def test_a_mesh_without_folds_is_handed_back_as_it_is():
    for mesh in (fine_box(), mesh_of(icosphere(3))):
        assert unfolded(mesh, edge_of(mesh)) is mesh


@settings(max_examples=25)
@given(
    chosen=st.sets(st.integers(0, 641), min_size=1, max_size=12),
    by=st.floats(1.3, 1.9),
    turn=st.floats(0.0, 3.0),
    scale=st.sampled_from([1e-3, 1.0, 1e3]),
)
def test_vertices_past_their_neighbours_are_brought_back(chosen, by, turn, scale):
    ball = mesh_of(icosphere(3))
    rotation = Rotation.from_rotvec([turn, 0.5, -turn]).as_matrix()
    ball = Mesh(scale * ball.vertices @ rotation.T + 7.0 * scale, ball.faces)
    folded = shoved(ball, sorted(chosen), by)
    found = unfolded(folded, edge_of(folded))
    before, after = self_intersecting(folded).sum(), self_intersecting(found).sum()
    assert after == 0 if before else found is folded
    np.testing.assert_array_equal(found.faces, folded.faces)
    moved = np.linalg.norm(found.vertices - folded.vertices, axis=1)
    assert moved.max() < 1.0001 * edge_of(folded)


def test_a_fold_far_away_moves_nothing_here():
    mesh = mesh_of(icosphere(3))
    corner = int(np.argmax(mesh.vertices.sum(axis=1)))
    folded = shoved(mesh, [corner], 1.8)
    assert self_intersecting(folded).any()
    found = unfolded(folded, edge_of(folded))
    assert not self_intersecting(found).any()
    away = np.linalg.norm(mesh.vertices - mesh.vertices[corner], axis=1) > 6.0 * edge_of(mesh)
    np.testing.assert_array_equal(found.vertices[away], folded.vertices[away])


def test_two_parts_that_pass_through_each_other_keep_their_shapes():
    first = fine_box()
    second = Mesh(first.vertices + np.array([0.31, 0.23, 0.17]), first.faces + len(first.vertices))
    both = Mesh(
        np.concatenate([first.vertices, second.vertices]), np.concatenate([first.faces, second.faces])
    )
    found = unfolded(both, edge_of(both))
    assert self_intersecting(found).any()
    assert np.linalg.norm(found.vertices - both.vertices, axis=1).max() <= 1.0001 * edge_of(both)


@pytest.mark.parametrize("by", [1.6, 3.0])
def test_looking_near_what_moved_finds_what_looking_everywhere_finds(by):
    mesh = mesh_of(icosphere(3))
    chosen = np.random.default_rng(0).choice(len(mesh.vertices), 9, replace=False)
    folded = shoved(mesh, chosen, by)
    everywhere = self_intersecting(folded)
    assert everywhere.any()
    np.testing.assert_array_equal(still_folded(folded, chosen), everywhere)


def test_confidence_stays_with_its_vertices():
    mesh = mesh_of(icosphere(3))
    confidence = np.linspace(0.0, 1.0, len(mesh.vertices))
    folded = shoved(mesh, [10], 1.8)
    found = unfolded(Mesh(folded.vertices, folded.faces, confidence), edge_of(folded))
    assert found.confidence is confidence

"""Folds are laid flat, those within a plane too, and nothing else is touched."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from trimesh.creation import box, icosphere

from weingarten.mesh import Mesh
from weingarten.metrics.self_intersections import self_intersecting
from weingarten.surface.folds import face_pairs, rounded, still_crossing, turned_back, unfolded


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


def folds(mesh):
    return self_intersecting(rounded(mesh)) | turned_back(mesh, face_pairs(mesh))


def shoved_within(mesh, vertex, by):
    """A vertex moved within the plane of its face, by so many times the way to a neighbour there."""
    vertices = mesh.vertices.copy()
    around = np.unique(mesh.faces[(mesh.faces == vertex).any(axis=1)])
    other = around[(around != vertex) & (vertices[around, 2] == vertices[vertex, 2])][0]
    vertices[vertex] += by * (vertices[other] - vertices[vertex])
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
    assert not folds(found).any()
    assert not self_intersecting(found).any()
    assert (found is folded) == (not folds(folded).any())
    np.testing.assert_array_equal(found.faces, folded.faces)
    moved = np.linalg.norm(found.vertices - folded.vertices, axis=1)
    assert moved.max() < 1.0001 * edge_of(folded)


@settings(max_examples=25)
@given(
    place=st.sampled_from([(0.25, 0.25), (0.0, 0.125), (-0.3125, 0.0625)]),
    by=st.floats(1.2, 1.9),
    turn=st.floats(0.0, 3.0),
)
def test_faces_upon_each_other_in_one_plane_are_parted_before_rounding_crosses_them(place, by, turn):
    flat = fine_box()
    vertex = int(np.argmin(np.linalg.norm(flat.vertices - [*place, 0.5], axis=1)))
    folded = shoved_within(flat, vertex, by)
    assert not self_intersecting(folded).any()
    assert turned_back(folded, face_pairs(folded)).any()
    found = unfolded(folded, edge_of(folded))
    np.testing.assert_array_equal(found.vertices[:, 2], folded.vertices[:, 2])
    assume(found.areas.min() > 1e-4 * folded.areas.max())
    turned = Mesh(found.vertices @ Rotation.from_rotvec([turn, 0.5, -turn]).as_matrix().T, found.faces)
    for mesh in (turned, rounded(turned)):
        assert not self_intersecting(mesh).any()


def test_what_is_called_folded_in_a_plane_does_cross_once_it_is_rounded():
    flat, turn = fine_box(), Rotation.from_rotvec([0.7, 0.5, -0.7]).as_matrix()
    crossing = 0
    for vertex in np.flatnonzero(flat.vertices[:, 2] == 0.5)[::17]:
        folded = Mesh(shoved_within(flat, int(vertex), 1.6).vertices @ turn.T, flat.faces)
        crossing += self_intersecting(rounded(folded)).any()
    assert crossing > 0


def test_an_edge_of_three_degrees_stays_as_sharp():
    blade = fine_box()
    wide, thick = blade.vertices[:, 0] + 0.5, blade.vertices[:, 2]
    blade = Mesh(
        np.stack([wide, blade.vertices[:, 1], thick * wide * 2.0 * np.tan(np.radians(1.5))], axis=1),
        blade.faces,
    )
    blade = Mesh(blade.vertices, blade.faces[blade.areas > 1e-12])
    assert unfolded(blade, edge_of(blade)) is blade


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
    np.testing.assert_array_equal(still_crossing(folded, chosen), everywhere)


def test_confidence_stays_with_its_vertices():
    mesh = mesh_of(icosphere(3))
    confidence = np.linspace(0.0, 1.0, len(mesh.vertices))
    folded = shoved(mesh, [10], 1.8)
    found = unfolded(Mesh(folded.vertices, folded.faces, confidence), edge_of(folded))
    assert found.confidence is confidence

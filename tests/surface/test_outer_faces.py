"""No vertex beyond the flat faces that bound the cloud; what curved parts and noise leave open stays."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from trimesh import Trimesh
from trimesh.creation import box, cone, icosphere
from trimesh.sample import sample_surface

from weingarten.mesh import Mesh
from weingarten.surface.outer_faces import outer_normals, within_outer_faces

TURN = Rotation.from_rotvec([0.3, -0.7, 0.5]).as_matrix()


def mesh_of(shape):
    return Mesh(np.asarray(shape.vertices, dtype=np.float64), np.asarray(shape.faces, dtype=np.int64))


def sampled(shape, count=5000):
    return np.asarray(sample_surface(shape, count, seed=0)[0], dtype=np.float64)


@pytest.mark.parametrize("turn", [np.eye(3), TURN])
def test_a_box_that_stands_out_is_put_back_whichever_way_it_lies(turn):
    truth = box((2.0, 1.0, 0.5))
    points = sampled(truth) @ turn.T
    bulged = mesh_of(truth.subdivide().subdivide())
    vertices = (bulged.vertices * [1.01, 1.02, 1.005]) @ turn.T
    found = within_outer_faces(Mesh(vertices, bulged.faces), points)
    assert np.abs(vertices @ turn).max(axis=0) == pytest.approx([1.01, 0.51, 0.25125])
    assert np.abs(found.vertices @ turn).max(axis=0) == pytest.approx([1.0, 0.5, 0.25], abs=3e-4)
    np.testing.assert_array_equal(found.faces, bulged.faces)


def test_faces_that_meet_obliquely_are_both_kept():
    profile = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (-2 / 3, 1.0), (1.0, -0.25)]
    roof = Trimesh([(x, y, z) for x, z in profile for y in (-1.0, 1.0)]).convex_hull
    points = sampled(roof, 20_000)
    swollen = mesh_of(roof.subdivide())
    vertices = roof.centroid + 1.02 * (swollen.vertices - roof.centroid)
    found = within_outer_faces(Mesh(vertices, swollen.faces), points).vertices
    slope = (found - [0, 0, 0.5]) @ [0.6, 0, 0.8]
    assert slope.max() < 1e-3
    assert np.abs(found).max() < 1.001


def test_what_is_within_stays_as_it_is():
    truth = box((2.0, 1.0, 0.5))
    inner = mesh_of(truth)
    inner = Mesh(0.99 * inner.vertices, inner.faces)
    np.testing.assert_array_equal(within_outer_faces(inner, sampled(truth)).vertices, inner.vertices)


def test_a_sphere_keeps_its_poles():
    ball = icosphere(4)
    found = within_outer_faces(mesh_of(ball), sampled(ball, 2000))
    np.testing.assert_allclose(np.linalg.norm(found.vertices, axis=1), 1.0, atol=2e-2)
    caps = 2.0 / 2000
    assert np.linalg.norm(found.vertices - ball.vertices, axis=1).mean() < 0.2 * caps


def test_a_tip_that_no_point_hit_is_left():
    tip = cone(0.5, 1.0, sections=128)
    found = within_outer_faces(mesh_of(tip.subdivide()), sampled(tip, 3000))
    assert found.vertices[:, 2].max() > 0.98


def test_noise_is_no_face():
    truth = box((2.0, 1.0, 0.5))
    deviation = 0.01
    points = sampled(truth, 20_000)
    points = points + deviation * np.random.default_rng(0).normal(size=points.shape)
    mesh = mesh_of(truth)
    np.testing.assert_array_equal(within_outer_faces(mesh, points).vertices, mesh.vertices)


def test_the_largest_faces_come_first():
    normals = outer_normals(sampled(box((2.0, 1.0, 0.5)), 20_000))
    assert len(normals) == 6
    np.testing.assert_allclose(np.abs(normals[:2, 2]), 1.0, atol=1e-3)


def test_points_without_a_hull_bound_nothing_but_their_box():
    flat = np.random.default_rng(0).uniform(-1, 1, (50, 3)) * [1, 1, 0]
    assert outer_normals(flat).shape == (0, 3)
    mesh = mesh_of(box((0.5, 0.5, 0.5)))
    assert np.abs(within_outer_faces(mesh, flat).vertices[:, 2]).max() == 0.0
    np.testing.assert_array_equal(within_outer_faces(mesh, flat[:5]).vertices, mesh.vertices)


@pytest.mark.parametrize(("turn", "box_lacks"), [(np.eye(3), 1e-3), (TURN, 0.03)])
def test_what_spans_a_hole_in_the_scan_is_no_face(turn, box_lacks):
    truth = box((2.0, 1.0, 0.5))
    points = sampled(truth, 20_000)
    points = points[np.linalg.norm(points - [1.0, 0.5, 0.25], axis=1) > 0.4]
    mesh = Mesh(0.999 * mesh_of(truth).vertices @ turn.T, mesh_of(truth).faces)
    found = within_outer_faces(mesh, points @ turn.T)
    np.testing.assert_allclose(found.vertices, mesh.vertices, atol=box_lacks)

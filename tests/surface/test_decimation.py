"""Fewer triangles: the same body, within the tolerance and no farther."""

import sys

import numpy as np
import pytest
import trimesh
from trimesh.creation import box, icosphere, torus

from weingarten.errors import MissingExtraError
from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.metrics.self_intersections import self_intersecting
from weingarten.metrics.topology import topology
from weingarten.samples.parts import part_mesh
from weingarten.surface.decimation import decimated, probes


def mesh_of(other: trimesh.Trimesh) -> Mesh:
    return Mesh(np.asarray(other.vertices, dtype=np.float64), np.asarray(other.faces, dtype=np.int64))


def cube(times: int = 5) -> Mesh:
    """Of side 1, 12 · 4ᵗⁱᵐᵉˢ triangles."""
    whole = box()
    for _ in range(times):
        whole = whole.subdivide()
    return mesh_of(whole)


BALL = mesh_of(icosphere(5))
SAGITTA = 1.0 - np.linalg.norm(BALL.corners.mean(axis=1), axis=1).min()


def test_a_cube_needs_twelve():
    found = decimated(cube(), 1e-5).mesh
    assert len(found.faces) == 12
    assert topology(found).volume == pytest.approx(1.0, rel=1e-5)
    np.testing.assert_allclose(np.abs(found.vertices), 0.5, atol=1e-5)


@pytest.mark.parametrize("tolerance", [3e-3, 0.03])
def test_a_ball_stays_one_within_the_tolerance(tolerance):
    found = decimated(BALL, tolerance).mesh
    radii = np.linalg.norm(probes(found), axis=1)
    assert len(found.faces) < 0.3 * len(BALL.faces)
    assert 1.0 - SAGITTA - 1.02 * tolerance < radii.min()
    assert radii.max() < 1.0 + 1.02 * tolerance
    assert (topology(found).genus, topology(found).watertight) == (0, True)
    assert not self_intersecting(found).any()


def test_the_more_it_may_move_the_fewer_it_needs():
    counts = [len(decimated(BALL, tolerance).mesh.faces) for tolerance in (1e-3, 3e-3, 1e-2, 0.03)]
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] < 0.2 * counts[0]


def test_bumps_go_where_they_are_smaller_than_the_tolerance_alone():
    plain = cube()
    bumps = 2e-4 * np.random.default_rng(0).normal(size=plain.vertices.shape)
    rough = Mesh(plain.vertices + bumps, plain.faces)
    assert len(decimated(rough, 2e-3).mesh.faces) < 100
    assert len(decimated(rough, 2e-5).mesh.faces) > 0.5 * len(rough.faces)


def test_handles_and_pieces_stay():
    ring, ball = mesh_of(torus(1.0, 0.3, major_sections=96, minor_sections=48)), mesh_of(icosphere(4))
    faces = np.concatenate([ring.faces, len(ring.vertices) + ball.faces])
    both = Mesh(np.concatenate([ring.vertices, np.array([3.0, 0.0, 0.0]) + ball.vertices]), faces)
    found = decimated(both, 0.02).mesh
    assert len(found.faces) < 0.2 * len(both.faces)
    assert (topology(found).components, topology(found).genus) == (2, 1)


def test_the_same_mesh_gives_the_same_triangles():
    one, two = decimated(BALL, 0.01).mesh, decimated(BALL, 0.01).mesh
    np.testing.assert_array_equal(one.vertices, two.vertices)
    np.testing.assert_array_equal(one.faces, two.faces)


def test_a_flange_of_marching_cubes_is_itself_with_a_tenth():
    """Its edges are chamfers of a cell, and the tolerance half of one."""
    world = part_mesh("flange", 96)
    flange = Mesh(Frame.of(world.vertices).to_unit(world.vertices), world.faces)
    found = decimated(flange, 0.01).mesh
    assert len(found.faces) < 0.1 * len(flange.faces)
    ours, theirs = topology(found), topology(flange)
    assert (ours.components, ours.genus) == (theirs.components, theirs.genus)
    assert ours.volume == pytest.approx(theirs.volume, rel=0.02)


def test_an_open_surface_keeps_its_rim():
    upper = BALL.faces[(BALL.corners[:, :, 2] > -1e-9).all(axis=1)]
    used, numbered = np.unique(upper, return_inverse=True)
    half = Mesh(BALL.vertices[used], numbered.reshape(-1, 3))
    found = decimated(half, 0.01)
    assert len(found.mesh.faces) < 0.5 * len(half.faces)
    assert not topology(found.mesh).watertight
    assert found.farthest <= 0.02


def test_a_fold_does_not_hold_up_the_rest():
    """One vertex drawn through the other side: what it carries along is nobody's surface."""
    vertices = BALL.vertices.copy()
    vertices[0] *= -1.5
    pierced = Mesh(vertices, BALL.faces)
    assert self_intersecting(pierced).any()
    found = decimated(pierced, 0.01)
    assert len(found.mesh.faces) < 0.5 * len(pierced.faces)
    assert found.distance <= 0.01


def test_what_cannot_do_with_fewer_is_returned():
    least = mesh_of(box())
    assert decimated(least, 1e-6).mesh is least


def test_without_the_extra_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "fast_simplification", None)
    with pytest.raises(MissingExtraError, match=r'pip install "weingarten\[simplify\]"'):
        decimated(BALL, 0.01)

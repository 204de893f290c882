"""Ghosts go, pieces that the scan supports stay."""

import numpy as np
import pytest
import trimesh

from weingarten.calculus.exact import Box, Difference, Sphere, Union
from weingarten.surface.contour import extract
from weingarten.surface.repair import drop_ghosts, pieces

BIG, SMALL, GHOST = ((-0.4, 0.0, 0.0), 0.5), ((0.5, 0.3, 0.0), 0.25), ((0.6, -0.6, 0.6), 0.15)


@pytest.fixture(scope="module")
def mesh():
    spheres = Union(tuple(Sphere(*one) for one in (BIG, SMALL, GHOST)))
    return extract(spheres, np.full(3, -1.1), np.full(3, 1.1), 48)


def on(sphere, count=500):
    directions = np.random.default_rng(0).normal(size=(count, 3))
    return np.asarray(sphere[0]) + sphere[1] * directions / np.linalg.norm(directions, axis=1)[:, None]


def volume(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume


def test_pieces_are_counted(mesh):
    assert pieces(mesh).max() == 2


def test_a_ghost_goes(mesh):
    kept = drop_ghosts(mesh, np.concatenate([on(BIG), on(SMALL)]))
    assert pieces(kept).max() == 1
    assert volume(kept) == pytest.approx(volume(mesh) - 4 / 3 * np.pi * 0.15**3, rel=3e-3)
    assert np.array_equal(np.unique(kept.faces), np.arange(len(kept.vertices)))


def test_the_piece_with_the_points_stays(mesh):
    kept = drop_ghosts(mesh, on(SMALL))
    assert pieces(kept).max() == 0
    assert volume(kept) == pytest.approx(4 / 3 * np.pi * 0.25**3, rel=0.03)


def test_a_void_inside_a_wall_goes_though_points_are_near():
    wall = Difference(Box(half=(0.8, 0.8, 0.05)), Sphere(radius=0.03))
    mesh = extract(wall, np.full(3, -1.1), np.full(3, 1.1), 160)
    assert pieces(mesh).max() == 1
    random = np.random.default_rng(0)
    faces = random.uniform(-0.8, 0.8, (5000, 3))
    faces[:, 2] = np.sign(faces[:, 2]) * 0.05
    kept = drop_ghosts(mesh, faces)
    assert pieces(kept).max() == 0
    assert kept.bounds[1, 0] > 0.79


def test_nothing_to_drop(mesh):
    every = np.concatenate([on(BIG), on(SMALL), on(GHOST)])
    assert drop_ghosts(mesh, every) is mesh

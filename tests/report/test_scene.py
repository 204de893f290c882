"""Meshes for the view in 3D: fewer triangles, more vertices, packed and unpacked again."""

import base64
import zlib

import numpy as np
import pytest
import trimesh

from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest
from weingarten.metrics.topology import topology
from weingarten.metrics.unit_cube import cube_frame
from weingarten.report.refine import refined
from weingarten.report.scene import Scene, packed, scene, slim, triangles_each, uncoloured
from weingarten.report.simplify import simplified

FRAME = Frame((0.0, 0.0, 0.0), 1.0)


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


BALL = as_mesh(trimesh.creation.icosphere(5))
BOX = as_mesh(trimesh.creation.box((3, 2, 1)))
TORUS = as_mesh(trimesh.creation.torus(2, 0.7, major_sections=120, minor_sections=60))


def unpacked(made: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, faces and levels, one number after another."""
    data = zlib.decompress(base64.b64decode(made.data))

    def plane(start: int, count: int, size: int) -> list[int]:
        values = [sum(data[start + k * count + i] << 8 * k for k in range(size)) for i in range(count)]
        return [-(value + 1) // 2 if value % 2 else value // 2 for value in values]

    v, f = made.vertices, made.faces
    steps = np.stack([np.cumsum(plane(2 * axis * v, v, 2)) for axis in range(3)], axis=1)
    a = np.cumsum(plane(6 * v, f, 3))
    b, c = (a + plane(6 * v + 3 * f * k, f, 3) for k in (1, 2))
    levels = np.frombuffer(data[6 * v + 9 * f :], dtype=np.uint8)
    return np.array(made.low) + steps * made.step, np.stack([a, b, c], axis=1), levels


@pytest.mark.parametrize("mesh", [BOX, TORUS, slim(TORUS, 900, 1.0, uncoloured).mesh])
def test_unpacking_gives_the_mesh_back(mesh: Mesh):
    levels = np.arange(len(mesh.vertices)).astype(np.uint8)
    made = scene(mesh, FRAME, levels)
    positions, faces, found = unpacked(made)
    assert np.abs(positions - mesh.vertices).max() < 0.51 * made.step + 1e-6
    assert made.step < 2e-4 * np.ptp(mesh.vertices, axis=0).max()
    assert np.array_equal(faces, mesh.faces)
    assert np.array_equal(found, levels)
    assert len(unpacked(scene(mesh, FRAME))[2]) == 0


def test_far_away_and_tiny_meshes_are_packed_in_the_frame():
    far = Mesh(TORUS.vertices * 1e-5 + 1e3, TORUS.faces)
    positions, _, _ = unpacked(scene(far, cube_frame(far)))
    assert np.abs(positions - cube_frame(TORUS).to_unit(TORUS.vertices)).max() < 1e-4


@pytest.mark.parametrize("mesh", [BALL, TORUS])
def test_fewer_triangles_keep_the_shape(mesh: Mesh):
    small = simplified(mesh, 2000)
    assert len(small.faces) <= 2100
    assert topology(small).genus == topology(mesh).genus
    assert closest(small, mesh.vertices).distance.max() < 0.02
    assert simplified(mesh, 10**6) is mesh


def test_rough_meshes_become_small_as_well():
    rough = Mesh(BALL.vertices + np.random.default_rng(0).normal(0, 0.02, BALL.vertices.shape), BALL.faces)
    assert len(simplified(rough, 2000).faces) <= 2100


def near_the_edges(points: np.ndarray) -> np.ndarray:
    """Levels as of a mesh with chamfered edges: large within 0.1 of the edges of BOX; and constant ones."""
    apart = np.sort(np.abs(np.abs(points) - [1.5, 1, 0.5]), axis=1)[:, 1]
    return np.stack([255 * np.clip(1 - apart / 0.1, 0, 1), np.full(len(points), 7.0)], axis=1)


def test_edges_are_cut_where_colours_between_vertices_would_be_wrong():
    fine, levels = refined(BOX, 6000, near_the_edges)
    assert 100 < len(fine.faces) <= 6100
    assert fine.areas.sum() == pytest.approx(BOX.areas.sum())
    assert topology(fine).watertight
    assert topology(fine).genus == 0
    assert topology(fine).volume == pytest.approx(6)
    assert np.array_equal(levels, near_the_edges(fine.vertices))
    weights = np.random.default_rng(0).dirichlet([1, 1, 1], len(fine.faces))
    areas = fine.areas / fine.areas.sum()
    places = np.einsum("fk,fki->fi", weights, fine.corners)
    shown = np.einsum("fk,fk->f", weights, levels[fine.faces][..., 0])
    wrong = areas @ np.abs(shown - near_the_edges(places)[:, 0])
    coarse = areas @ np.abs(255 - near_the_edges(places)[:, 0])
    assert wrong < 0.05 * coarse, (wrong, coarse)


def test_levels_that_interpolate_well_cut_nothing():
    def linear(points: np.ndarray) -> np.ndarray:
        return points[:, :1] * 20 + 100

    for levels_at in (linear, uncoloured):
        assert refined(BOX, 5000, levels_at)[0] is BOX
    few = refined(BOX, len(BOX.faces) + 7, near_the_edges)[0]
    assert len(BOX.faces) < len(few.faces) <= len(BOX.faces) + 8


def test_slim_meshes_use_every_vertex_in_order_and_keep_its_levels():
    found = slim(TORUS, 900, 0.8, lambda points: 100 + 20 * points[:, 2:])
    small = found.mesh
    assert len(small.faces) <= 950
    _, first = np.unique(small.faces.reshape(-1), return_index=True)
    assert (np.diff(first) > 0).all()
    assert len(first) == len(small.vertices)
    assert np.abs(found.levels[:, 0] - (100 + 20 * small.vertices[:, 2])).max() <= 0.5


def test_many_scenes_are_small():
    """25 parts and 8 contenders: below 17 MB, however rough the meshes are."""
    parts, contenders = 25, 8
    rough = Mesh(BALL.vertices + np.random.default_rng(0).normal(0, 0.004, BALL.vertices.shape), BALL.faces)
    each = triangles_each(parts, contenders)

    def noise(points: np.ndarray) -> np.ndarray:
        return np.random.default_rng(1).uniform(0, 60, (len(points), 1))

    mesh, truth = slim(rough, each, 0.8, noise), slim(rough, int(1.5 * each), 0.4, noise)
    sizes = [len(scene(one.mesh, FRAME, one.levels[:, 0]).data) for one in (mesh, truth)]
    missed = len(packed(truth.levels[:, 0].tobytes()))
    assert parts * (contenders * (sizes[0] + missed) + sizes[1]) < 17e6
    assert triangles_each(1, 1) > triangles_each(50, 8) > triangles_each(10**5, 2)

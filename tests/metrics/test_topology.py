"""topology of shapes whose Euler number is known."""

import numpy as np
import pytest
import trimesh

from weingarten.mesh import Mesh
from weingarten.metrics.topology import topology


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


def joined(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts[:-1], strict=True)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def moved(mesh: Mesh, *by: float) -> Mesh:
    return Mesh(mesh.vertices + np.array(by), mesh.faces)


BOX = as_mesh(trimesh.creation.box((1, 2, 3)))
TORUS = as_mesh(trimesh.creation.torus(3, 1))
CUBE = as_mesh(trimesh.creation.box((1, 1, 1)))


def test_box():
    found = topology(BOX)
    assert (found.watertight, found.oriented, found.components, found.euler, found.genus) == (
        True,
        True,
        1,
        2,
        0,
    )
    assert found.volume == pytest.approx(6)


def test_torus_has_one_handle():
    found = topology(TORUS)
    assert (found.watertight, found.euler, found.genus) == (True, 0, 1)


def test_genus_adds_up_over_components():
    found = topology(joined(TORUS, moved(TORUS, 20, 0, 0), moved(BOX, 0, 20, 0)))
    assert (found.components, found.euler, found.genus) == (3, 2, 2)


def test_triangle_soup_is_the_same_surface():
    soup = Mesh(TORUS.corners.reshape(-1, 3), np.arange(3 * len(TORUS.faces)).reshape(-1, 3))
    assert topology(soup).genus == 1
    assert topology(soup).watertight


def test_negative_zero_is_zero():
    vertices = CUBE.vertices - CUBE.vertices.min(axis=0)
    soup = vertices[CUBE.faces]
    soup[::2][soup[::2] == 0] = -0.0
    assert topology(Mesh(soup.reshape(-1, 3), np.arange(36).reshape(-1, 3))).watertight


def test_volume_far_from_the_origin_and_inside_out():
    assert topology(moved(BOX, 1e6, -1e6, 1e6)).volume == pytest.approx(6, rel=1e-9)
    assert topology(Mesh(BOX.vertices, BOX.faces[:, ::-1])).volume == pytest.approx(-6)


def test_a_missing_face_opens_the_mesh():
    found = topology(Mesh(BOX.vertices, BOX.faces[1:]))
    assert (found.watertight, found.oriented, found.euler, found.genus) == (False, True, 1, None)


def test_a_turned_face_spoils_the_orientation():
    faces = BOX.faces.copy()
    faces[0] = faces[0, ::-1]
    found = topology(Mesh(BOX.vertices, faces))
    assert (found.watertight, found.oriented, found.genus) == (True, False, None)


def test_cubes_that_touch_at_a_vertex_are_two_closed_surfaces():
    found = topology(joined(CUBE, moved(CUBE, 1, 1, 1)))
    assert (found.watertight, found.components, found.euler, found.genus) == (True, 2, 4, 0)


def test_cubes_that_touch_along_an_edge_are_not_watertight():
    found = topology(joined(CUBE, moved(CUBE, 1, 1, 0)))
    assert (found.watertight, found.genus) == (False, None)


def test_unused_vertices_and_degenerate_faces_count_for_nothing():
    vertices = np.concatenate([BOX.vertices, [[50.0, 60, 70]]])
    found = topology(Mesh(vertices, np.concatenate([BOX.faces, [[8, 8, 0], [1, 2, 2]]])))
    assert found == topology(BOX)


def test_empty_mesh():
    found = topology(Mesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)))
    assert (found.watertight, found.components, found.euler, found.volume) == (False, 0, 0, 0.0)

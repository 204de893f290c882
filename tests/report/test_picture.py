"""The rasteriser against a slow reference, and what a picture must show."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from weingarten.errors import OutputError
from weingarten.mesh import Mesh
from weingarten.report import picture as module
from weingarten.report import rasteriser
from weingarten.report.picture import picture, write_picture
from weingarten.report.rasteriser import EMPTY, rasterise
from weingarten.report.shading import corner_normals, shade
from weingarten.scan.sampling import sample_surface


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


BOX = as_mesh(trimesh.creation.box((1, 1, 1)))
PANEL = 300
SPHERE = as_mesh(trimesh.creation.icosphere(4))


def slow_raster(corners: np.ndarray, height: int, width: int) -> np.ndarray:
    """Foremost face at every pixel centre by barycentric coordinates, one pixel and face at a time."""
    face = np.full((height, width), EMPTY)
    for row in range(height):
        for column in range(width):
            best = -np.inf
            for index, triangle in enumerate(corners):
                matrix = np.vstack([triangle[:, :2].T, np.ones(3)])
                weights = np.linalg.solve(matrix, [column + 0.5, row + 0.5, 1])
                if (weights > 0).all() and weights @ triangle[:, 2] > best:
                    best, face[row, column] = weights @ triangle[:, 2], index
    return face


@pytest.mark.parametrize("chunk", [rasteriser.CHUNK, 7])
def test_rasteriser_agrees_with_the_slow_reference(monkeypatch: pytest.MonkeyPatch, chunk: int):
    monkeypatch.setattr(rasteriser, "CHUNK", chunk)
    corners = np.random.default_rng(0).uniform(-6, 26, (25, 3, 3))
    assert np.array_equal(rasterise(corners, 18, 22).face, slow_raster(corners, 18, 22))


def test_neighbours_leave_no_holes():
    """A fan of slivers round a point on pixel centres covers its square."""
    angle = np.linspace(0, 2 * np.pi, 400)
    rim = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    rim = 30 * rim / np.abs(rim).max(axis=1, keepdims=True) + [32.5, 32.5, 0]
    corners = np.stack([np.broadcast_to([32.5, 32.5, 0], rim[1:].shape), rim[:-1], rim[1:]], axis=1)
    face = rasterise(corners, 65, 65).face
    assert (face[4:61, 4:61] != EMPTY).all()
    assert (face[:2] == EMPTY).all()


def test_off_screen_edge_on_and_empty_input():
    away = np.array([[[-9, -9, 0], [-5, -9, 0], [-9, -5, 0]], [[2, 2, 0], [2, 2, 5], [2, 9, 3]]], dtype=float)
    assert (rasterise(away, 8, 8).face == EMPTY).all()
    assert (rasterise(np.empty((0, 3, 3)), 8, 8).face == EMPTY).all()


def test_corner_normals_are_flat_on_a_box_and_radial_on_a_sphere():
    flat = corner_normals(BOX)
    assert np.abs(flat).max(axis=2) == pytest.approx(1)
    radial = np.einsum("fki,fki->fk", corner_normals(SPHERE), SPHERE.corners)
    assert radial.min() > 0.9999


def test_the_inside_of_a_surface_is_drawn_in_another_colour():
    front, back = shade(np.array([[0.0, 0, 1], [0, 0, -1]]))
    assert front[2] > front[0]
    assert back[0] > back[2]


def test_picture_shows_both_in_one_view():
    points, _ = sample_surface(SPHERE, 10_000, 0)
    pixels = np.asarray(picture(points, SPHERE, panel=PANEL))
    assert pixels.shape[1] == 2 * PANEL
    ink = (pixels[:PANEL] < 250).any(axis=2)
    left, right = ink[:, :PANEL], ink[:, PANEL:]
    radius = 0.44 * PANEL
    assert right.sum() == pytest.approx(np.pi * radius**2, rel=0.01)
    assert not (left & ~right).sum() > 0.01 * right.sum()
    assert left.sum() > 0.3 * right.sum()
    middle = pixels[PANEL // 2, PANEL + PANEL // 2].astype(int)
    assert middle.min() > 100


def test_points_drawn_in_blocks_are_the_same_picture(monkeypatch: pytest.MonkeyPatch):
    points, _ = sample_surface(SPHERE, 2000, 0)
    whole = np.asarray(picture(points, BOX, panel=PANEL))
    monkeypatch.setattr(module, "BLOCK", 300)
    assert np.array_equal(np.asarray(picture(points, BOX, panel=PANEL)), whole)


def test_nearer_surfaces_hide_farther_ones():
    """A closed sphere shows no inside, a bowl open to the viewer does."""
    points = SPHERE.vertices
    closed = np.asarray(picture(points, SPHERE, panel=PANEL))[:, PANEL:].astype(int)
    towards = SPHERE.corners.mean(axis=1) @ [0.46, -0.73, 0.5]
    bowl = np.asarray(picture(points, Mesh(SPHERE.vertices, SPHERE.faces[towards < 0]), panel=PANEL))[
        :, PANEL:
    ].astype(int)
    assert not (closed[..., 0] - closed[..., 2] > 20).any()
    assert (bowl[..., 0] - bowl[..., 2] > 20).mean() > 0.3


def test_flat_and_tiny_inputs_are_drawn():
    flat = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]) * 1e-6 + 1e3, np.array([[0, 1, 2]]))
    assert picture(flat.vertices, flat, panel=PANEL).size[0] == 2 * PANEL
    assert (
        picture(np.zeros((1, 3)), Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)), panel=PANEL).size[
            0
        ]
        == 2 * PANEL
    )


def test_write_picture(tmp_path: Path):
    path = tmp_path / "view.png"
    write_picture(path, BOX.vertices, BOX)
    with Image.open(path) as image:
        assert image.size[0] == 1800
    assert [file.name for file in tmp_path.iterdir()] == ["view.png"]
    for bad in ("view.gif", "none/view.png"):
        with pytest.raises(OutputError):
            write_picture(tmp_path / bad, BOX.vertices, BOX)

"""Meshes for the browser: few triangles, none of them large, with and without the extra."""

import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from weingarten.errors import MissingExtraError
from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest
from weingarten.metrics.topology import topology
from weingarten.view import display
from weingarten.view.display import LONGEST, clustered, displayed, few, finer

sys.path.insert(0, str(Path(__file__).parent))
from exhibits import CENTRE, RADIUS, mesh

BOX = trimesh.creation.box((3, 2, 1))
BOX = Mesh(np.array(BOX.vertices, dtype=np.float64), np.array(BOX.faces, dtype=np.int64))


def test_large_triangles_are_cut_and_the_surface_stays():
    fine = finer(BOX, 100_000)
    edges = fine.corners - np.roll(fine.corners, 1, axis=1)
    assert np.linalg.norm(edges, axis=2).max() <= 3 * LONGEST
    assert fine.areas.sum() == pytest.approx(BOX.areas.sum())
    assert topology(fine).watertight
    assert len(finer(BOX, 500).faces) <= 500


def test_many_triangles_become_few_and_it_is_said():
    shown = displayed(mesh(5), 3000)
    assert shown.whole == 20 * 4**5
    assert len(shown.mesh.faces) < 7500
    assert f"in place of {20 * 4**5:,}" in shown.note
    assert closest(shown.mesh, mesh(2).vertices).distance.max() < 0.01 * RADIUS
    assert displayed(mesh(3), 3000).note == ""


def test_without_the_extra_vertices_are_clustered(monkeypatch):
    def missing(mesh: Mesh, most: int) -> Mesh:
        raise MissingExtraError("no fast_simplification")

    monkeypatch.setattr(display, "simplified", missing)
    shown = displayed(mesh(5), 3000)
    assert 'install "weingarten[report]"' in shown.note
    plain = clustered(mesh(5), 3000)
    assert 1000 < len(plain.faces) <= 3000
    assert np.abs(np.linalg.norm(plain.vertices - CENTRE, axis=1) - RADIUS).max() < 0.03 * RADIUS


def test_few_points_are_evenly_picked():
    points = np.arange(30.0).reshape(10, 3)
    assert len(few(points, 10)) == 10
    assert few(points, 4)[:, 0].tolist() == [0, 9, 18, 27]

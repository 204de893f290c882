"""Meshes that the tests of the metrics share."""

import csv
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh

from weingarten.io.mesh import read_mesh
from weingarten.mesh import Mesh

ABC25 = Path(os.environ.get("WEINGARTEN_ABC25", Path(__file__).parents[2] / "../shared/data/abc25"))
needs_abc25 = pytest.mark.skipif(
    not (ABC25 / "index.csv").is_file(), reason="abc25 is not beside the repository"
)
TURN = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))[:3, :3]
QUARTER_TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


def similar(mesh: Mesh, scale: float = 1.0, turn=None, shift: float = 0.0) -> Mesh:
    turned = mesh.vertices @ (np.eye(3) if turn is None else turn).T
    return Mesh(scale * turned + shift, mesh.faces)


def moved(mesh: Mesh, *by: float) -> Mesh:
    return Mesh(mesh.vertices + np.array(by), mesh.faces)


def joined(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts[:-1], strict=True)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def turned_over(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces[:, ::-1].copy())


def opened(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces[1:])


def square(*corners: tuple[float, float, float]) -> Mesh:
    return Mesh(np.array(corners, dtype=np.float64), np.array([[0, 1, 2], [0, 2, 3]]))


def bent(mesh: Mesh, amount: float = 0.01) -> Mesh:
    """A smoothly deformed copy, off by at most `amount` of the longest side along every axis."""
    size = np.ptp(mesh.vertices, axis=0).max()
    waves = np.sin(7 * mesh.vertices[:, [1, 2, 0]] / size + [0.3, 1.1, 2.0])
    return Mesh(mesh.vertices + amount * size * waves, mesh.faces)


def abc_rows() -> list[dict[str, str]]:
    """The rows of abc25's index; none where it is not there."""
    if not (ABC25 / "index.csv").is_file():
        return []
    with (ABC25 / "index.csv").open() as stream:
        return list(csv.DictReader(stream))


def abc_part(name: str) -> Mesh:
    return read_mesh(ABC25 / f"{name}.ply")


CUBE = as_mesh(trimesh.creation.box((1, 1, 1)))
BOX = as_mesh(trimesh.creation.box((1, 0.5, 0.25)))
SPHERE = as_mesh(trimesh.creation.icosphere(4))
NONE = Mesh(np.eye(3), np.empty((0, 3), dtype=np.int64))

"""What every mesh of an extraction must be."""

import numpy as np
import trimesh


def solid(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


def assert_closed(mesh):
    """Every edge has two faces that run along it in opposite directions, and no face is degenerate."""
    faces = mesh.faces
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    codes = directed[:, 0] * len(mesh.vertices) + directed[:, 1]
    reverse = directed[:, 1] * len(mesh.vertices) + directed[:, 0]
    assert (directed[:, 0] != directed[:, 1]).all()
    assert len(np.unique(codes)) == len(codes)
    assert np.array_equal(np.sort(codes), np.sort(reverse))
    assert np.array_equal(np.unique(faces), np.arange(len(mesh.vertices)))
    assert np.isfinite(mesh.vertices).all()

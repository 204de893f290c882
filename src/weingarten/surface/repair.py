"""Removal of ghosts: closed pieces of the zero set far from every point of the scan."""

import numpy as np
from jaxtyping import Bool, Float64, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from weingarten.mesh import Mesh


def drop_ghosts(mesh: Mesh, points: Float64[np.ndarray, "n 3"], distance: float) -> Mesh:
    """The mesh without the connected pieces that have no vertex within a distance of any point.

    The piece of the largest area always stays. A mesh without ghosts is returned as it is.

    mesh, points: in one and the same frame.
    distance: in that frame's unit.
    """
    piece = pieces(mesh)
    count = int(piece.max(initial=-1)) + 1
    if count < 2:
        return mesh
    gap, _ = KDTree(points).query(mesh.vertices, distance_upper_bound=distance)
    keep = np.zeros(count, dtype=bool)
    keep[piece[np.isfinite(gap)]] = True
    area = np.bincount(piece[mesh.faces[:, 0]], weights=mesh.areas, minlength=count)
    keep[np.argmax(area)] = True
    return mesh if keep.all() else _part(mesh, keep[piece])


def pieces(mesh: Mesh) -> Int[np.ndarray, " v"]:
    """Number of the connected piece of every vertex, from 0; vertices are connected by edges of faces."""
    start = mesh.faces.ravel()
    end = np.roll(mesh.faces, -1, axis=1).ravel()
    shape = (len(mesh.vertices), len(mesh.vertices))
    graph = coo_array((np.ones(len(start), dtype=np.int8), (start, end)), shape=shape)
    return connected_components(graph, directed=False)[1]


def _part(mesh: Mesh, keep: Bool[np.ndarray, " v"]) -> Mesh:
    """The faces between kept vertices, numbered anew."""
    number = np.cumsum(keep) - 1
    faces = mesh.faces[keep[mesh.faces[:, 0]]]
    return Mesh(mesh.vertices[keep], number[faces].astype(np.int64))

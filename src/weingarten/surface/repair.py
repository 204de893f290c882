"""Removal of ghosts: closed pieces of the zero set that no points of the scan support."""

import numpy as np
from jaxtyping import Bool, Float64, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from weingarten.mesh import Mesh

SUPPORT = 0.1
"""Share of the points expected by its area that a piece must have nearest to itself."""

FEWEST = 12
"""Points that a piece must have in any case: fewer are what outliers leave."""

MOST_POINTS = 200_000
"""At most so many points, evenly picked, are asked."""


def drop_ghosts(mesh: Mesh, points: Float64[np.ndarray, "n 3"]) -> Mesh:
    """The mesh without the connected pieces that the scan does not support.

    Every point speaks for the piece that its nearest vertex belongs to. A piece stays when it has at least a
    tenth of the points that its share of the area lets expect, and FEWEST; a void inside a wall has none,
    though points are near. The piece with the most points always stays. A mesh without ghosts is returned as
    it is.

    mesh, points: in one and the same frame.
    """
    piece = pieces(mesh)
    count = int(piece.max(initial=-1)) + 1
    if count < 2:
        return mesh
    asked = points[:: max(1, -(-len(points) // MOST_POINTS))]
    _, nearest = KDTree(mesh.vertices).query(asked, workers=-1)
    voices = np.bincount(piece[nearest], minlength=count)
    area = np.bincount(piece[mesh.faces[:, 0]], weights=mesh.areas, minlength=count)
    keep = (voices > SUPPORT * len(asked) * area / area.sum()) & (voices >= FEWEST)
    keep[np.argmax(voices)] = True
    return mesh if keep.all() else _part(mesh, keep[piece])


def pieces(mesh: Mesh) -> Int[np.ndarray, " v"]:
    """Number of the connected piece of every vertex, from 0; vertices are connected by edges of faces.

    Two edges of a face connect its three vertices.
    """
    start, end = mesh.faces[:, :2].ravel(), mesh.faces[:, 1:].ravel()
    shape = (len(mesh.vertices), len(mesh.vertices))
    graph = coo_array((np.ones(len(start), dtype=np.int8), (start, end)), shape=shape)
    return connected_components(graph, directed=False)[1]


def _part(mesh: Mesh, keep: Bool[np.ndarray, " v"]) -> Mesh:
    """The faces between kept vertices, numbered anew."""
    number = np.cumsum(keep) - 1
    faces = mesh.faces[keep[mesh.faces[:, 0]]]
    return Mesh(mesh.vertices[keep], number[faces].astype(np.int64))

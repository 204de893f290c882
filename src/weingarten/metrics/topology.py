"""What a mesh is as a surface: closed, oriented, in how many pieces, with how many handles.

Everything is decided by indices after vertices at exactly equal positions have been merged, so that a
triangle soup (STL) and an indexed mesh of the same part give the same answer. Unreferenced vertices and
faces with two equal corners count for nothing.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from weingarten.io.coincident import coincident
from weingarten.mesh import Mesh
from weingarten.metrics.unit_cube import used_box

Faces = Int64[np.ndarray, "f 3"]


@dataclass(frozen=True)
class Topology:
    """Topology of a mesh.

    watertight: every undirected edge is used by exactly two faces (and there is a face).
    oriented: no directed edge is used twice, so neighbours agree on what is outside.
    components: sets of faces connected through edges.
    euler: V − E + F, with a vertex at which several sheets touch counted once for each sheet.
    genus: Σ over components (2 − euler) / 2, the number of handles; None unless watertight and oriented.
    volume: enclosed by the surface, in the mesh's unit cubed, negative when inside out; of an open mesh,
        that of its cone from the centre of its box.
    """

    watertight: bool
    oriented: bool
    components: int
    euler: int
    genus: int | None
    volume: float


def topology(mesh: Mesh) -> Topology:
    """The topology of a mesh in any frame."""
    faces = merged_faces(mesh)
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    _, edge, uses = np.unique(edge_keys(faces), return_inverse=True, return_counts=True)
    watertight = bool(len(faces)) and bool((uses == 2).all())
    directed = np.sort(start * (int(faces.max(initial=0)) + 1) + end)
    oriented = not (directed[1:] == directed[:-1]).any()
    first, second = half_edge_pairs(edge.reshape(-1))
    components = _parts(len(faces), first // 3, second // 3)[0]
    fans = corner_fans(faces, first, second)
    euler = int(fans.max(initial=-1)) + 1 - len(uses) + len(faces)
    genus = components - euler // 2 if watertight and oriented else None
    return Topology(watertight, oriented, components, euler, genus, volume(mesh))


def volume(mesh: Mesh) -> float:
    """⅙ Σ a · (b × c) over the faces (divergence theorem), corners taken from the centre of their box."""
    if not len(mesh.faces):
        return 0.0
    lowest, highest = used_box(mesh)
    a, b, c = (mesh.corners - (lowest + highest) / 2).transpose(1, 0, 2)
    return float(np.einsum("fi,fi->", a, np.cross(b, c)) / 6)


def merged_faces(mesh: Mesh) -> Faces:
    """Faces over the distinct vertex positions; those with two equal corners left out."""
    faces = coincident(mesh.vertices)[1][mesh.faces]
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (c != a)]


def edge_keys(faces: Faces) -> Int64[np.ndarray, " h"]:
    """A number for every half-edge, the same for all on one edge.

    Half-edge 3 f + k runs from corner k of face f to the next.
    """
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    return np.minimum(start, end) * (int(faces.max(initial=0)) + 1) + np.maximum(start, end)


def edge_ends(faces: Faces, half: Int64[np.ndarray, " e"]) -> Int64[np.ndarray, "e 2"]:
    """The vertices at the ends of these half-edges, the lower number first."""
    start, end = faces.reshape(-1)[half], np.roll(faces, -1, axis=1).reshape(-1)[half]
    return np.stack([np.minimum(start, end), np.maximum(start, end)], axis=1)


def half_edge_pairs(edge: Int64[np.ndarray, " h"]) -> tuple[Int64[np.ndarray, " p"], Int64[np.ndarray, " p"]]:
    """Pairs of half-edges with the same key, or number, of their edge.

    An edge used by m faces gives m − 1 pairs, which chain all of them.
    """
    order = np.argsort(edge, kind="stable")
    same = edge[order[1:]] == edge[order[:-1]]
    return order[:-1][same], order[1:][same]


def corner_fans(
    faces: Faces, first: Int64[np.ndarray, " p"], second: Int64[np.ndarray, " p"]
) -> Int64[np.ndarray, "f 3"]:
    """A number for every face corner, equal for corners of one vertex joined through the given pairs.

    On a manifold the fans are the vertices; a vertex where two sheets touch has two.
    """
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    following = np.arange(3 * len(faces)).reshape(-1, 3)[:, [1, 2, 0]].reshape(-1)
    opposite = ends[first, 0] == ends[second, 1]
    start, stop = second, following[second]
    left = np.concatenate([first, following[first]])
    right = np.concatenate([np.where(opposite, stop, start), np.where(opposite, start, stop)])
    return _parts(3 * len(faces), left, right)[1].reshape(-1, 3)


def _parts(
    count: int, left: Int64[np.ndarray, " p"], right: Int64[np.ndarray, " p"]
) -> tuple[int, Int64[np.ndarray, " count"]]:
    """Number of connected components of a graph on `count` nodes, and each node's component."""
    if not count:
        return 0, np.zeros(0, dtype=np.int64)
    graph = coo_matrix((np.ones(len(left), dtype=bool), (left, right)), shape=(count, count))
    number, labels = connected_components(graph, directed=False)
    return int(number), labels.astype(np.int64)

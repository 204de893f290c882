"""Folds are laid flat: faces that pass through others, or lie back upon their neighbours.

A vertex that was put onto an edge may come to lie beyond its neighbours, and a bulge that was put onto a flat
face may lie there twice. Of two faces that lie upon each other in one plane neither passes through the other,
until rounding lifts them apart. So a face is folded that passes through another where positions are rounded
to single precision, as files have them, or whose normal is opposite to that of a face across one of its
edges, n · n′ < BACK. Vertices of folded faces go half way to the mean of their neighbours, v ← ½ (v + mean),
until none is left: one to three rounds where the surface is sound. None goes farther than it is allowed to,
so parts that truly pass through each other keep their shapes.
"""

import numpy as np
from jaxtyping import Bool, Int64
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from weingarten.mesh import Mesh
from weingarten.metrics.normals import face_normals
from weingarten.metrics.self_intersections import self_intersecting
from weingarten.metrics.topology import edge_keys, half_edge_pairs

BACK = -0.999
"""Cosine of the turn at an edge, to within two and a half degrees of a half turn."""

ROUNDS = 12
"""At most."""

Pairs = tuple[Int64[np.ndarray, " p"], Int64[np.ndarray, " p"]]


def unfolded(mesh: Mesh, most: float) -> Mesh:
    """The same faces, of which none are folded, or as few as were found, in a frame near the origin.

    most: how far a vertex may be moved. The mesh itself is returned where none are, or no fewer.
    """
    across = face_pairs(mesh)
    folded = self_intersecting(rounded(mesh)) | turned_back(mesh, across)
    if not folded.any():
        return mesh
    beside, vertices = neighbours(mesh), mesh.vertices.copy()
    best, least = mesh, int(folded.sum())
    for _ in range(ROUNDS):
        moved = np.unique(mesh.faces[folded])
        way = 0.5 * (vertices[moved] + beside[moved] @ vertices) - mesh.vertices[moved]
        length = np.linalg.norm(way, axis=1, keepdims=True)
        vertices[moved] = mesh.vertices[moved] + way * np.minimum(1.0, most / np.maximum(length, 1e-300))
        found = Mesh(vertices, mesh.faces, mesh.confidence)
        folded = still_crossing(rounded(found), moved) | turned_back(found, across)
        if folded.sum() < least:
            least, best = int(folded.sum()), Mesh(vertices.copy(), mesh.faces, mesh.confidence)
        if least == 0:
            break
    return best


def rounded(mesh: Mesh) -> Mesh:
    """The mesh with positions of single precision."""
    return Mesh(mesh.vertices.astype(np.float32).astype(np.float64), mesh.faces)


def face_pairs(mesh: Mesh) -> Pairs:
    """Faces that have an edge in common."""
    one, other = half_edge_pairs(edge_keys(mesh.faces))
    return one // 3, other // 3


def turned_back(mesh: Mesh, across: Pairs) -> Bool[np.ndarray, " f"]:
    """Which faces lie back upon one that they have an edge in common with."""
    normals, (one, other) = face_normals(mesh), across
    opposite = np.einsum("ni,ni->n", normals[one], normals[other]) < BACK
    found = np.zeros(len(mesh.faces), dtype=bool)
    found[one[opposite]] = found[other[opposite]] = True
    return found


def neighbours(mesh: Mesh) -> csr_array:
    """The matrix that takes positions to the mean of a vertex's neighbours; closed meshes count each once."""
    start, end = mesh.faces.reshape(-1), np.roll(mesh.faces, -1, axis=1).reshape(-1)
    number = np.maximum(np.bincount(start, minlength=len(mesh.vertices)), 1)
    size = (len(mesh.vertices), len(mesh.vertices))
    return csr_array((1.0 / number[start], (start, end)), shape=size)


def still_crossing(mesh: Mesh, moved: Int64[np.ndarray, " m"]) -> Bool[np.ndarray, " f"]:
    """Which faces pass through others, if none did that have no vertex of those that moved.

    Only faces near one that has are looked at: two that meet are no farther apart, middle to middle, than
    both reach.
    """
    touched = np.zeros(len(mesh.vertices), dtype=bool)
    touched[moved] = True
    middles = mesh.corners.mean(axis=1)
    reach = 2.0 * float(np.linalg.norm(mesh.corners - middles[:, None], axis=2).max())
    tree = KDTree(middles[touched[mesh.faces].any(axis=1)])
    near = np.isfinite(tree.query(middles, distance_upper_bound=reach, workers=-1)[0])
    folded = np.zeros(len(mesh.faces), dtype=bool)
    folded[near] = self_intersecting(Mesh(mesh.vertices, mesh.faces[near]))
    return folded

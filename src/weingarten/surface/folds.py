"""Faces that pass through others are laid flat: the folds that vertices on sharp edges leave behind.

A vertex that was put onto an edge may come to lie beyond its neighbours. Those of faces that pass through
others go half way to the mean of their neighbours, v ← ½ (v + mean), until no face does: one to three rounds
where the surface is sound. None goes farther than it is allowed to, so parts that truly pass through each
other keep their shapes.
"""

import numpy as np
from jaxtyping import Bool, Int64
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from weingarten.mesh import Mesh
from weingarten.metrics.self_intersections import self_intersecting

ROUNDS = 12
"""At most."""


def unfolded(mesh: Mesh, most: float) -> Mesh:
    """The same faces, of which none pass through others, or as few as were found, in any frame.

    most: how far a vertex may be moved. The mesh itself is returned where none do, or no fewer.
    """
    folded = self_intersecting(mesh)
    least, best = int(folded.sum()), mesh.vertices
    if least == 0:
        return mesh
    beside, vertices = neighbours(mesh), mesh.vertices.copy()
    for _ in range(ROUNDS):
        moved = np.unique(mesh.faces[folded])
        way = 0.5 * (vertices[moved] + beside[moved] @ vertices) - mesh.vertices[moved]
        length = np.linalg.norm(way, axis=1, keepdims=True)
        vertices[moved] = mesh.vertices[moved] + way * np.minimum(1.0, most / np.maximum(length, 1e-300))
        folded = still_folded(Mesh(vertices, mesh.faces), moved)
        if folded.sum() < least:
            least, best = int(folded.sum()), vertices.copy()
        if least == 0:
            break
    return mesh if best is mesh.vertices else Mesh(best, mesh.faces, mesh.confidence)


def neighbours(mesh: Mesh) -> csr_array:
    """The matrix that takes positions to the mean of a vertex's neighbours; closed meshes count each once."""
    start, end = mesh.faces.reshape(-1), np.roll(mesh.faces, -1, axis=1).reshape(-1)
    number = np.maximum(np.bincount(start, minlength=len(mesh.vertices)), 1)
    size = (len(mesh.vertices), len(mesh.vertices))
    return csr_array((1.0 / number[start], (start, end)), shape=size)


def still_folded(mesh: Mesh, moved: Int64[np.ndarray, " m"]) -> Bool[np.ndarray, " f"]:
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

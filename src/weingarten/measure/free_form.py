"""Where on a mesh no primitive was found."""

from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from weingarten.measure.labels import NONE, Labels
from weingarten.mesh import Mesh

LEAST = 1e-3
"""Share of the mesh's area below which a piece is not worth a line."""


def free_patches(mesh: Mesh, labels: Labels) -> tuple[dict[str, Any], ...]:
    """Connected pieces of faces free-form at all corners: share of the area, box; the largest first."""
    faces = mesh.faces[(labels[mesh.faces] == NONE).all(axis=1)]
    if not len(faces):
        return ()
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    count = len(mesh.vertices)
    graph = coo_matrix((np.ones(len(start), dtype=bool), (start, end)), shape=(count, count))
    piece = connected_components(graph, directed=False)[1][faces[:, 0]]
    areas, whole = Mesh(mesh.vertices, faces).areas, float(mesh.areas.sum())
    found = []
    for number in np.unique(piece):
        own = piece == number
        share = float(areas[own].sum()) / whole
        if share >= LEAST:
            box = Mesh(mesh.vertices[np.unique(faces[own])], faces[:0]).bounds
            found.append({"share": share, "box": box.tolist()})
    return tuple(sorted(found, key=lambda patch: -patch["share"]))

"""Faces of a mesh that pass through other faces of it.

Two faces pass through each other when an edge of the one crosses the inside of the other:

    [p a b c] [q a b c] < 0   and   [p q a b], [p q b c], [p q c a] of one sign,

with [p a b c] = (a − p) · ((b − p) × (c − p)), for an edge pq and a face abc. Faces that only touch do not,
nor do faces in one plane: a volume whose sign may be rounding's is none. Of faces with a common corner the
edges opposite to it are asked; those with a common edge are left out. Pairs are found in a grid: each cell
lists the faces whose boxes reach into it.
"""

import numpy as np
from jaxtyping import Bool

from weingarten.mesh import Mesh
from weingarten.metrics.face_pairs import mark, reached

MOST_CELLS = 400
"""Along the longest side of the mesh."""

MOST_ENTRIES = 64
"""Cells that a face reaches into, on average: where it would be more, large faces are among small ones, and
the cells are made larger."""

GROWTH = 1.5
"""By how much, at a time. Nothing reaches into more than eight cells in the end."""


def self_intersecting(mesh: Mesh) -> Bool[np.ndarray, " f"]:
    """Which faces pass through another, in any frame. Corners are compared by their indices."""
    found = np.zeros(len(mesh.faces), dtype=bool)
    if len(found) < 2:
        return found
    corners = mesh.corners
    first, second, third = (corners - mesh.vertices.min(axis=0)).transpose(1, 0, 2)
    lowest = np.minimum(np.minimum(first, second), third)
    highest = np.maximum(np.maximum(first, second), third)
    extent = (highest - lowest).max(axis=1)
    cell = max(float(2.0 * np.median(extent)), float(highest.max()) / MOST_CELLS)
    if not cell > 0.0:
        return found
    while True:
        begin, end = (lowest / cell).astype(np.int64), (highest / cell).astype(np.int64)
        entries = int((end - begin + 1).prod(axis=1).sum())
        if entries <= MOST_ENTRIES * len(found):
            break
        cell *= GROWTH
    side = int(end.max()) + 1
    keys, owners = reached(begin, end, side, entries)
    order = np.argsort(keys, kind="stable")
    mark(corners, mesh.faces, lowest, highest, keys[order], owners[order], side, cell, found)
    return found

"""Marching cubes: vertices on lattice edges, triangles within cells.

A vertex is the zero of the linear interpolant of the two end values; the error is O(h²) on smooth parts, and
an edge of the part that lies between nodes is cut off by up to about h/2.
"""

import numpy as np
from jaxtyping import Float64, Int, Int32

from weingarten.mesh import Mesh
from weingarten.surface.cases import AXIS, END, START, cases
from weingarten.surface.cells import Cells, numbered


def marching_cubes(cells: Cells) -> Mesh:
    """The triangles of all cells, vertices shared by lattice edge."""
    table, case, corners = cases(), cells.case, cells.corners
    count = table.count[case]
    owner = np.repeat(np.arange(len(corners)), count)
    row = np.arange(len(owner)) + np.repeat(table.start[case] - (np.cumsum(count) - count), count)
    edge = table.triangles[row]
    keys = 4 * corners[owner[:, None], START[edge]] + AXIS[edge]
    unique, faces = numbered(keys, 4 * len(cells.nodes))
    ends = np.empty(len(unique), dtype=np.int32)
    ends[faces] = corners[owner[:, None], END[edge]]
    vertices = _vertices(unique, ends, cells)
    _place_centres(vertices, unique, faces)
    return Mesh(vertices, faces)


def _vertices(
    keys: Int[np.ndarray, " v"], ends: Int32[np.ndarray, " v"], cells: Cells
) -> Float64[np.ndarray, "v 3"]:
    """Zeros of the linear interpolant on the edges; vertices in a cell stay at its lowest node."""
    low, axis = keys // 4, keys % 4
    direction = np.concatenate([np.eye(3, dtype=np.int32), np.zeros((1, 3), dtype=np.int32)])[axis]
    on_edge = axis < 3
    share = np.zeros(len(keys))
    share[on_edge] = cells.shares(low[on_edge], ends[on_edge])
    return cells.lattice.positions(cells.nodes[low] + share[:, None] * direction)


def _place_centres(
    vertices: Float64[np.ndarray, "v 3"], keys: Int[np.ndarray, " v"], faces: Int[np.ndarray, "f 3"]
) -> None:
    """Move every vertex in a cell to the mean of the vertices around it; it is a face's last corner."""
    centre = keys % 4 == 3
    fans = faces[centre[faces[:, 2]]]
    total = np.zeros_like(vertices)
    np.add.at(total, fans[:, 2], vertices[fans[:, 0]])
    number = np.bincount(fans[:, 2], minlength=len(vertices))
    vertices[centre] = total[centre] / number[centre, None]

"""Dual contouring: vertices within cells, on the sharp edges that pass there, faces across lattice edges.

Every loop of a cell (`weingarten.surface.cases`) has one vertex v, where the planes (p_i, m_i) of its
crossings meet best (Ju et al. 2002):

    min Σ_i (m_i·(v − p_i))²,   in directions that the planes leave open nearest to the mean of the p_i

Where there is no edge and all but one direction is open, v is half as far from that mean: planes that touch a
curved surface meet as far outside of it as the mean of their points is inside.

Every crossed lattice edge has one face, whose corners are the vertices of the four cells around it. So the
mesh is dual to that of marching cubes and has its topology (Nielson 2004; Schaefer, Ju and Warren 2007).
Where two loops meet in both segments of an ambiguous face, an edge would have four faces: there each segment
gets a vertex of its own, and the faces beside it one in their middle.

Vertices may leave their cells by as much as the edge was rounded; where surfaces are nearer to each other
than that, faces can pass through each other.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int, Int64

from weingarten.crew import Crew
from weingarten.mesh import Mesh
from weingarten.surface.cases import AXIS, END, START, loops
from weingarten.surface.cells import Cells, numbered
from weingarten.surface.planes import NOTHING, Measure, Planes, Points, unrounded

OPEN = 0.08
"""Directions with less than this share of the greatest eigenvalue are open."""

STEP = 1.5
"""How far a vertex may lie from the mean of its crossings, cells."""

AROUND = np.array([0, 1, 3, 2])
"""Place in the ring around a lattice edge of the cell that has it as its edge 4a + k."""


@dataclass(frozen=True)
class Crossings:
    """Lattice edges with a change of sign.

    points: where the linear interpolant is zero, unit frame. ring: vertices of the four cells around each,
    counter-clockwise seen from outside. partner: beside each corner of the ring the crossing that the side to
    the next corner has in common with it, that is, its segment's other end. count: of vertices.
    """

    points: Points
    ring: Int64[np.ndarray, "n 4"]
    partner: Int64[np.ndarray, "n 4"]
    count: int

    @classmethod
    def of(cls, cells: Cells) -> "Crossings":
        """Those of all cells."""
        table, case = loops(), cells.case
        cell, edge = np.nonzero(table.of[case] >= 0)
        edges = np.stack([edge, table.after[case[cell], edge]])
        keys = 4 * cells.corners[cell, START[edges]] + AXIS[edges]
        unique, (own, following) = numbered(keys, 4 * len(cells.nodes))
        count = table.count[case].astype(np.int64)
        vertex = (np.cumsum(count) - count)[cell] + table.of[case[cell], edge]
        ring, partner = (np.empty((len(unique), 4), dtype=np.int64) for _ in range(2))
        ring[own, AROUND[edge % 4]], partner[own, AROUND[edge % 4]] = vertex, following
        start, end = unique // 4, np.empty(len(unique), dtype=np.int32)
        end[own] = cells.corners[cell, END[edge]]
        turned = cells.values[start] >= 0
        ring[turned], partner[turned] = ring[turned, ::-1], partner[turned, ::-1]
        along = cells.shares(start, end)[:, None] * np.eye(3)[unique % 4]
        points = cells.lattice.positions(cells.nodes[start] + along)
        return cls(points, ring, partner, int(count.sum()))


class SharpContour:
    """A mesher whose vertices lie on sharp edges.

    measure: tells the planes of the surface near points. known: planes of it that nothing has rounded. crew:
    who does the work.
    """

    def __init__(self, measure: Measure, known: Planes = NOTHING, crew: Crew | None = None) -> None:
        self.measure, self.known, self.crew = measure, known, crew or Crew()

    def __call__(self, cells: Cells) -> Mesh:
        """The mesh of all cells."""
        crossings = Crossings.of(cells)
        points, normals = unrounded(self.measure(crossings.points), self.known, self.crew)
        vertices = placed(crossings, points, normals, STEP * cells.lattice.step)
        return joined(vertices, crossings, points, normals)


def placed(crossings: Crossings, points: Points, normals: Points, most: float) -> Float64[np.ndarray, "v 3"]:
    """The vertex of every loop; most: its greatest distance from the crossings' mean."""
    ring, count = crossings.ring.reshape(-1), crossings.count
    number = np.bincount(ring, minlength=count)

    def total(values: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " v"]:
        return np.bincount(ring, np.repeat(values, 4), minlength=count)

    def mean(positions: Points) -> Float64[np.ndarray, "v 3"]:
        return np.stack([total(axis) for axis in positions.T], axis=1) / number[:, None]

    middle, seen = mean(points), mean(crossings.points)
    offset = (normals * points).sum(axis=1)
    quadric = np.empty((count, 3, 3))
    pull = np.empty((count, 3))
    for i in range(3):
        pull[:, i] = total(normals[:, i] * offset)
        for j in range(3):
            quadric[:, i, j] = total(normals[:, i] * normals[:, j])
    pull -= np.einsum("vij,vj->vi", quadric, middle)
    value, vector = np.linalg.eigh(quadric)
    inverse = np.where(value > OPEN * value[:, 2:], 1.0 / np.maximum(value, 1e-300), 0.0)
    inverse[value[:, 1] <= OPEN * value[:, 2]] *= 0.5
    move = middle - seen + np.einsum("vij,vj,vkj,vk->vi", vector, inverse, vector, pull)
    length = np.linalg.norm(move, axis=1, keepdims=True)
    return seen + move * np.minimum(1.0, most / np.maximum(length, 1e-300))


def joined(
    vertices: Float64[np.ndarray, "v 3"], crossings: Crossings, points: Points, normals: Points
) -> Mesh:
    """Triangles of all rings: two each, or a fan around the crossing where an edge would have four faces."""
    ring = crossings.ring
    following = np.roll(ring, -1, axis=1)
    low, high = np.minimum(ring, following), np.maximum(ring, following)
    _, side, uses = np.unique(low * len(vertices) + high, return_inverse=True, return_counts=True)
    double = (uses > 2)[side].reshape(ring.shape)
    fanned = np.asarray(double.any(axis=1))
    faces = halves(vertices, ring[~fanned], normals[~fanned])
    if not fanned.any():
        return Mesh(vertices, faces)
    own = np.nonzero(fanned)[0]
    centre = np.empty(len(ring), dtype=np.int64)
    centre[own] = len(vertices) + np.arange(len(own))
    at, corner = np.nonzero(double)
    pair = np.sort(np.stack([at, crossings.partner[at, corner]], axis=1), axis=1)
    segments, segment = np.unique(pair, axis=0, return_inverse=True)
    between = len(vertices) + len(own) + segment.reshape(-1)
    plain, place = np.nonzero(fanned[:, None] & ~double)
    fans = [
        np.stack([centre[plain], ring[plain, place], following[plain, place]], axis=1),
        np.stack([centre[at], ring[at, corner], between], axis=1),
        np.stack([centre[at], between, following[at, corner]], axis=1),
    ]
    added = [vertices, points[own], points[segments].mean(axis=1)]
    return Mesh(np.concatenate(added), np.concatenate([faces, *fans]))


def halves(
    vertices: Float64[np.ndarray, "v 3"], ring: Int[np.ndarray, "n 4"], normals: Float64[np.ndarray, "n 3"]
) -> Int64[np.ndarray, "f 3"]:
    """Every quadrilateral as the two triangles that face the more alike to its crossing's normal."""
    ways = [(ring[:, [0, 1, 2]], ring[:, [0, 2, 3]]), (ring[:, [1, 2, 3]], ring[:, [1, 3, 0]])]
    first, second = (np.minimum(*(facing(vertices[half], normals) for half in way)) for way in ways)
    chosen = (first >= second)[:, None]
    return np.concatenate([np.where(chosen, one, other) for one, other in zip(*ways, strict=True)])


def facing(
    corners: Float64[np.ndarray, "n 3 3"], normals: Float64[np.ndarray, "n 3"]
) -> Float64[np.ndarray, " n"]:
    """Cosine between the normal of each triangle and a given one; 0 for one without area."""
    a, b, c = corners.transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    return (cross * normals).sum(axis=1) / np.maximum(np.linalg.norm(cross, axis=1), 1e-300)

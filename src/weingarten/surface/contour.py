"""The zero set of a field as a closed triangle mesh: marching cubes over the cells that the octree found.

The mesh is watertight whatever the field is: every edge has exactly two faces, the sides of the box close
what leaves it, and a node on which the field vanishes (|f| < 1e-6·h, h the cell's side) counts as outside
by that much, so faces that lie in the lattice's own planes make no holes. Vertices lie on lattice edges,
at the zero of the linear interpolant of the two end values; the error is O(h²) on smooth parts, and an
edge of the part that lies between nodes is cut off by up to about h/2.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int, Int64

from weingarten.mesh import Mesh
from weingarten.surface.bricks import Bricks
from weingarten.surface.cases import AXIS, CORNERS, FACES, START, cases
from weingarten.surface.lattice import Lattice
from weingarten.surface.octree import Octree, Values

BATCH = 8192
_TOUCHING = 1e-3
_LEAST_SHARE = 1e-3
"""Vertices keep this share of an edge from its nodes, so that single precision cannot merge two of them."""


@dataclass(frozen=True)
class Extraction:
    """What an extraction gave and what it cost.

    mesh: in the unit frame.
    evaluations: points at which the field was evaluated.
    notes: sentences for the user, about what was done to the surface.
    """

    mesh: Mesh
    evaluations: int
    notes: tuple[str, ...] = ()


def extract(
    values: Values,
    lower: Float64[np.ndarray, " 3"],
    upper: Float64[np.ndarray, " 3"],
    resolution: int,
    batch: int = BATCH,
) -> Mesh:
    """The zero set of a field inside a box, watertight, wound so that normals point to positive values.

    values: the field, (n, 3) float32 positions in the unit frame → (n,); about a distance, of any scale.
    lower, upper: corners of the box, unit frame.
    resolution: cubic cells along the box's longest side.
    batch: points a call of the field; blocks of some thousand stay in the processor's cache.

    Raises ExtractionError where the field does not change sign in the box or is not finite, OptionError
    for an empty box or a resolution below 2.
    """
    return extraction(values, lower, upper, resolution, batch).mesh


def extraction(
    values: Values,
    lower: Float64[np.ndarray, " 3"],
    upper: Float64[np.ndarray, " 3"],
    resolution: int,
    batch: int = BATCH,
) -> Extraction:
    """As extract, with the number of evaluations and notes."""
    lattice = Lattice.over(lower, upper, resolution)
    octree = Octree(values, lattice, batch)
    octree.refine()
    mesh = _mesh(octree.bricks, lattice)
    notes = ()
    if lattice.depths(lattice.places(mesh.vertices)).min() < _TOUCHING:
        notes = ("The surface leaves the extraction box and was closed at the box's sides.",)
    return Extraction(mesh, octree.evaluations, notes)


def _mesh(bricks: Bricks, lattice: Lattice) -> Mesh:
    """The triangles of all cells with a change of sign, vertices shared by lattice edge."""
    table = cases()
    cells = _crossed(bricks)
    corners = np.stack([bricks.find(cells + corner) for corner in CORNERS], axis=1)
    case = _case(bricks.low[corners])
    count = table.count[case]
    owner = np.repeat(np.arange(len(cells)), count)
    row = np.arange(len(owner)) + np.repeat(table.start[case] - (np.cumsum(count) - count), count)
    edge = table.triangles[row]
    keys = 4 * corners[owner[:, None], START[edge]].astype(np.int64) + AXIS[edge]
    unique, faces = _numbered(keys, 4 * len(bricks.low))
    vertices = _vertices(unique, bricks, lattice)
    _place_centres(vertices, unique, faces)
    return Mesh(vertices, faces)


def _numbered(
    keys: Int[np.ndarray, "f 3"], limit: int
) -> tuple[Int[np.ndarray, " v"], Int64[np.ndarray, "f 3"]]:
    """The different keys in ascending order, and the number of each key among them."""
    used = np.zeros(limit, dtype=bool)
    used[keys] = True
    unique = np.nonzero(used)[0]
    number = np.empty(limit, dtype=np.int32)
    number[unique] = np.arange(len(unique), dtype=np.int32)
    return unique, number[keys].astype(np.int64)


def _crossed(bricks: Bricks) -> Int[np.ndarray, "n 3"]:
    """Lowest nodes of the cells that have corners of both signs."""
    found = [np.empty((0, 3), dtype=np.int32)]
    span = (slice(None, -1), slice(1, None))
    for first, signs in bricks.padded_signs():
        corners = [signs[:, span[a], span[b], span[c]] for a, b, c in CORNERS]
        mixed = (np.minimum.reduce(corners) < 0) & (np.maximum.reduce(corners) > 0)
        mixed &= np.logical_and.reduce(corners)
        brick, x, y, z = np.nonzero(mixed)
        found.append(first[brick] + np.stack([x, y, z], axis=1).astype(np.int32))
    return np.concatenate(found)


def _case(values: Float32[np.ndarray, "n 8"]) -> Int[np.ndarray, " n"]:
    """Case of every cell: bit c for an inside corner c, bit 8 + face for a face whose insides are joined.

    On an ambiguous face the bilinear interpolant has a saddle; it is inside where the product of the two
    inside values exceeds that of the two outside ones.
    """
    inside = values < 0
    case = (inside << np.arange(8)).sum(axis=1)
    for face, (a, b, c, d) in enumerate(FACES):
        alike = (inside[:, a] == inside[:, c]) & (inside[:, b] == inside[:, d])
        at = np.nonzero(alike & (inside[:, a] != inside[:, b]))[0]
        corner = values[at].astype(np.float64)
        product, other = corner[:, a] * corner[:, c], corner[:, b] * corner[:, d]
        joined = np.where(inside[at, a], product > other, other > product)
        case[at] |= joined << (8 + face)
    return case


def _vertices(keys: Int[np.ndarray, " v"], bricks: Bricks, lattice: Lattice) -> Float64[np.ndarray, "v 3"]:
    """Zeros of the linear interpolant on the edges; vertices in a cell stay at its lowest node."""
    low, axis = bricks.nodes(keys // 4), keys % 4
    direction = np.concatenate([np.eye(3, dtype=np.int32), np.zeros((1, 3), dtype=np.int32)])[axis]
    start = bricks.low[keys // 4].astype(np.float64)
    end = bricks.low[bricks.find(low + direction)].astype(np.float64)
    on_edge = axis < 3
    share = np.zeros(len(keys))
    share[on_edge] = start[on_edge] / (start[on_edge] - end[on_edge])
    share[on_edge] = share[on_edge].clip(_LEAST_SHARE, 1.0 - _LEAST_SHARE)
    return lattice.positions(low + share[:, None] * direction)


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

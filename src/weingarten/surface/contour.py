"""The zero set of a field as a closed triangle mesh: marching cubes over the cells that the octree found.

The mesh is watertight whatever the field is: every edge has exactly two faces, the sides of the box close
what leaves it, and a node on which the field vanishes (|f| < 1e-6·h, h the cell's side) counts as outside
by that much, so faces that lie in the lattice's own planes make no holes. Vertices lie on lattice edges,
at the zero of the linear interpolant of the two end values; the error is O(h²) on smooth parts, and an
edge of the part that lies between nodes is cut off by up to about h/2.
"""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float32, Float64, Int, Int32, Int64
from torch import Tensor

from weingarten.crew import Crew
from weingarten.mesh import Mesh
from weingarten.surface.bounds import with_next
from weingarten.surface.bricks import SIDE, Bricks
from weingarten.surface.cases import AXIS, CORNERS, END, FACES, START, cases
from weingarten.surface.flood import CROSSING
from weingarten.surface.lattice import Lattice
from weingarten.surface.octree import Octree, Values

BATCH = 8192
BLOCK = SIDE + 1
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
    crew: Crew | None = None,
) -> Extraction:
    """As extract, with the number of evaluations and notes. crew: who does the work on a CPU."""
    crew = crew or Crew()
    lattice = Lattice.over(lower, upper, resolution)
    octree = Octree(values, lattice, batch, crew)
    octree.refine()
    mesh = _mesh(octree.bricks, lattice, crew, octree.piece)
    notes = ()
    if lattice.depths(lattice.places(mesh.vertices)).min() < _TOUCHING:
        notes = ("The surface leaves the extraction box and was closed at the box's sides.",)
    return Extraction(mesh, octree.evaluations, notes)


def _mesh(bricks: Bricks, lattice: Lattice, crew: Crew, piece: int) -> Mesh:
    """The triangles of all cells with a change of sign, vertices shared by lattice edge."""
    table = cases()
    corners, nodes, values = _crossed(bricks, crew, piece)
    case = _case(values[corners])
    count = table.count[case]
    owner = np.repeat(np.arange(len(corners)), count)
    row = np.arange(len(owner)) + np.repeat(table.start[case] - (np.cumsum(count) - count), count)
    edge = table.triangles[row]
    keys = 4 * corners[owner[:, None], START[edge]] + AXIS[edge]
    unique, faces = _numbered(keys, 4 * len(nodes))
    ends = np.empty(len(unique), dtype=np.int32)
    ends[faces] = corners[owner[:, None], END[edge]]
    vertices = _vertices(unique, ends, nodes, values, lattice)
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


def _crossed(
    bricks: Bricks, crew: Crew, piece: int
) -> tuple[Int32[np.ndarray, "n 8"], Int32[np.ndarray, "v 3"], Float32[np.ndarray, " v"]]:
    """The cells that have corners of both signs, by numbers of nodes; these nodes, and their values.

    All that leaves the field's device.
    """
    shifts = torch.from_numpy(CORNERS @ np.array([BLOCK**2, BLOCK, 1])).to(bricks.bounds.device)

    def crossed(slots: Int32[Tensor, " b"]) -> Int32[Tensor, "m 8"]:
        addresses = bricks.block(bricks.firsts(slots), BLOCK)
        sides = bricks.sides(addresses)
        for shift in (1, BLOCK, BLOCK**2):
            sides = with_next(torch.bitwise_or, sides, shift)
        own = (sides == CROSSING).view(-1, BLOCK, BLOCK, BLOCK)
        own[:, -1], own[:, :, -1], own[:, :, :, -1] = False, False, False
        return addresses[own.view(-1).nonzero() + shifts]

    with torch.no_grad(), crew:
        corners = torch.cat(crew.map(crossed, bricks.slots(piece)))
        number = torch.zeros(bricks.bounds.shape[1], dtype=torch.int32, device=corners.device)
        number[corners] = 1
        used = number.nonzero().squeeze(1).to(torch.int32)
        number[used] = torch.arange(len(used), dtype=torch.int32, device=corners.device)
        found = number[corners], bricks.nodes(used).T, bricks.bounds[0, used]
    x, y, z = (part.cpu().numpy() for part in found)
    return x, y, z


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


def _vertices(
    keys: Int[np.ndarray, " v"],
    ends: Int32[np.ndarray, " v"],
    nodes: Int32[np.ndarray, "n 3"],
    values: Float32[np.ndarray, " n"],
    lattice: Lattice,
) -> Float64[np.ndarray, "v 3"]:
    """Zeros of the linear interpolant on the edges; vertices in a cell stay at its lowest node."""
    low, axis = keys // 4, keys % 4
    direction = np.concatenate([np.eye(3, dtype=np.int32), np.zeros((1, 3), dtype=np.int32)])[axis]
    start, end = values[low].astype(np.float64), values[ends].astype(np.float64)
    on_edge = axis < 3
    share = np.zeros(len(keys))
    share[on_edge] = start[on_edge] / (start[on_edge] - end[on_edge])
    share[on_edge] = share[on_edge].clip(_LEAST_SHARE, 1.0 - _LEAST_SHARE)
    return lattice.positions(nodes[low] + share[:, None] * direction)


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

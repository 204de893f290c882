"""The lattice edges with a change of sign, and what they lack for a closed surface.

Such an edge needs values at its two ends and the side of every node of its four cells.
"""

import itertools

import torch
from jaxtyping import Bool, Int32, Int64, UInt8
from torch import Tensor

from weingarten.crew import Crew
from weingarten.surface.bounds import with_next
from weingarten.surface.bricks import INSIDE, OUTSIDE, SIDE, UNKNOWN, Bricks

Edges = tuple[Int32[Tensor, "3 a"], Int32[Tensor, "3 b"], Int32[Tensor, "3 c"]]
"""Lower nodes of the lattice edges along each axis."""

BLOCK = SIDE + 2
"""A brick and one layer of nodes around it."""

CROSSING = OUTSIDE | INSIDE


def crossings(bricks: Bricks, crew: Crew, piece: int) -> tuple[bool, Int32[Tensor, " n"], Edges]:
    """Whether any edge changes sign; ends of such edges that lack a value; the edges that lack a side.

    Ends are addresses, and may occur more than once. piece: bricks to be looked at together.
    """
    found = crew.map(lambda slots: _crossings_of(bricks, slots), bricks.slots(piece))
    ends = torch.cat([ends for _, ends, _ in found])
    x, y, z = (bricks.nodes(torch.cat([part[2][axis] for part in found])) for axis in range(3))
    return any(some for some, _, _ in found), ends, (x, y, z)


def _crossings_of(
    bricks: Bricks, slots: Int32[Tensor, " b"]
) -> tuple[bool, Int32[Tensor, " n"], list[Int32[Tensor, " m"]]]:
    """The same of some bricks; edges by the addresses of their lower nodes."""
    addresses = bricks.block(bricks.firsts(slots) - 1, BLOCK)
    sides = bricks.sides(addresses)
    own = _own(len(slots), sides.device)
    ends, lacking = [], []
    for axis in range(3):
        shift = BLOCK ** (2 - axis)
        crossing = (with_next(torch.bitwise_or, sides, shift) == CROSSING) & own
        at = crossing.nonzero().squeeze(1)
        ends += [addresses[at], addresses[at + shift]]
        lacking.append(addresses[at[_around(sides, at, axis) >= UNKNOWN]])
    ends = torch.cat(ends)
    return len(ends) > 0, ends[~bricks.exact(ends)], lacking


def _around(sides: UInt8[Tensor, " n"], edges: Int64[Tensor, " m"], axis: int) -> UInt8[Tensor, " m"]:
    """The sides that occur among the 18 nodes of the four cells around edges of an axis, in flat blocks."""
    found = with_next(torch.bitwise_or, sides, BLOCK ** (2 - axis))
    below = 0
    for other in {0, 1, 2} - {axis}:
        shift = BLOCK ** (2 - other)
        found = with_next(torch.bitwise_or, with_next(torch.bitwise_or, found, shift), shift)
        below += shift
    return found[edges - below]


def _own(blocks: int, device: torch.device) -> Bool[Tensor, " n"]:
    """Where a node of a flat block is the brick's own, not of the layer around it."""
    own = torch.zeros(blocks, BLOCK, BLOCK, BLOCK, dtype=torch.bool, device=device)
    own[:, 1:-1, 1:-1, 1:-1] = True
    return own.view(-1)


def crossings_at(bricks: Bricks, nodes: Int32[Tensor, "3 n"]) -> Edges:
    """The lattice edges with a change of sign that end at the nodes."""
    sides = bricks.sides(bricks.find(nodes))
    found = []
    for axis in range(3):
        above, below = nodes.clone(), nodes.clone()
        above[axis] += 1
        below[axis] -= 1
        up = sides | bricks.sides(bricks.find(above)) == CROSSING
        down = sides | bricks.sides(bricks.find(below)) == CROSSING
        found.append(torch.cat([below[:, down], nodes[:, up]], dim=1))
    x, y, z = found
    return x, y, z


def wanted(bricks: Bricks, ends: Int32[Tensor, " n"], edges: Edges) -> Int32[Tensor, " m"]:
    """The addresses, in ascending order, of ends and of all that edges lack; makes the bricks they are in."""
    around = [list(_eighteen(nodes, axis)) for axis, nodes in enumerate(edges) if nodes.shape[1]]
    for _, nodes in itertools.chain(*around):
        bricks.cover(nodes)
    bricks.grow()
    marks = torch.zeros(bricks.bounds.shape[1], dtype=torch.bool, device=ends.device)
    marks[ends] = True
    for is_end, nodes in itertools.chain(*around):
        at = bricks.find(nodes)
        marks[at[~bricks.exact(at) if is_end else bricks.sides(at) == UNKNOWN]] = True
    return marks.nonzero().squeeze(1).to(torch.int32)


def _eighteen(nodes, axis):
    """The nodes of the four cells around edges of an axis; with each, whether it is an end."""
    for along, u, v in itertools.product((0, 1), (-1, 0, 1), (-1, 0, 1)):
        offset = torch.tensor([along, u, v], dtype=torch.int32, device=nodes.device).roll(axis)
        yield (u, v) == (0, 0), nodes + offset[:, None]

"""From the bounds at the corners of cells to those at their 27 half-way nodes, one lattice finer.

With ‖∇f‖ ≤ L, a bound p at the distance d is p − L·d. A half-way node has 1, 2, 4 or 8 nearest corners, by
the number k of its odd coordinates, each at √k half edges; the largest of their bounds less L·d is its own.
It depends on the node alone, not on the cell that it is seen from, so every node is worked out once.

Blocks are flat: (2, b·s³) for the bounds of b blocks of s³ nodes. A neighbour along an axis is a shift by
1, s or s², so that every operation runs over one long piece of memory; what a shift brings into a block from
the next one is at the block's upper side, where nobody reads it.
"""

import itertools
import math
from collections.abc import Callable

import torch
from jaxtyping import Bool, Float32
from torch import Tensor

PARITIES = tuple(itertools.product((0, 1), repeat=3))
"""Odd coordinates of the eight half-way nodes next to a corner; lists by parity have this order."""


def halfway(bounds: Float32[Tensor, "2 n"], side: int, reach: float) -> list[Float32[Tensor, "2 n"]]:
    """Bounds at the half-way nodes next to every node of blocks, by parity.

    reach: L times half an edge.
    """
    found = [bounds]
    for shift in (1, side, side**2):
        found += [with_next(torch.maximum, part, shift) for part in found]
    for parity, part in zip(PARITIES[1:], found[1:], strict=True):
        part -= reach * math.sqrt(sum(parity))
    return found


def least(found: list[Float32[Tensor, "2 n"]], side: int) -> Float32[Tensor, "2 n"]:
    """The least of 27 bounds, those of the cell above every node of blocks, from what `halfway` gave."""
    for shift in (side**2, side, 1):
        half = len(found) // 2
        ends = [with_next(torch.minimum, part, shift) for part in found[:half]]
        found = [torch.minimum(*pair, out=pair[0]) for pair in zip(ends, found[half:], strict=True)]
    return found[0]


def of_cells(cells: Bool[Tensor, " n"], side: int) -> list[Bool[Tensor, " n"]]:
    """Which half-way nodes next to the nodes of blocks belong to one of the cells, by parity.

    Blocks of cells begin a cell lower on every axis than the blocks of nodes.
    """
    found = [cells]
    for shift in (1, side, side**2):
        even = [with_next(torch.logical_or, part, shift) for part in found]
        found = even + [part.roll(-shift) for part in found]
    return found


def interleaved(found: list[Float32[Tensor, "2 n"]], side: int) -> Float32[Tensor, "2 b s s s"]:
    """The half-way nodes next to all but the last nodes of blocks, from those of each parity."""
    last = side - 1
    blocks = found[0].shape[1] // side**3
    whole = found[0].new_empty(2, blocks, 2 * last, 2 * last, 2 * last)
    for (x, y, z), part in zip(PARITIES, found, strict=True):
        own = part.view(2, blocks, side, side, side)
        whole[:, :, x::2, y::2, z::2] = own[:, :, :last, :last, :last]
    return whole


def with_next(combine: Callable[..., Tensor], values: Tensor, shift: int) -> Tensor:
    """Every value combined with the one `shift` further on; the last ones are copied."""
    joined = torch.empty_like(values)
    combine(values[..., :-shift], values[..., shift:], out=joined[..., :-shift])
    joined[..., -shift:] = values[..., -shift:]
    return joined

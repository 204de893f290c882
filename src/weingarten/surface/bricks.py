"""A sparse store of what is known about the field at lattice nodes: two bounds for every stored node.

Nodes live in bricks of 8³; a small table maps a brick's coordinates to its slot, so that finding a node
costs a few integer operations. A brick exists only where somebody asked for one of its nodes; slot 0 is a
brick of which nothing is known, and stands for all that do not exist.

The bounds (p, q) of a node say f ≥ p and −f ≥ q, f in [p, −q]: so whatever is done to one is done to the
other. p = −q is a value that was evaluated, p > 0 a node that is surely outside, q > 0 one that is surely
inside, p = q = −∞ a node of which nothing is known. Bounds that contradict each other (p > 0 and q > 0: the
field was steeper than assumed) say nothing either.

All tensors are on one device.
"""

import itertools

import torch
from jaxtyping import Bool, Float32, Int32, UInt8
from torch import Tensor

SIDE = 8
VOLUME = SIDE**3
OUTSIDE, INSIDE, UNKNOWN = 1, 2, 4
"""Sides of the surface; the bits of several nodes together say which sides occur among them."""


class Bricks:
    """Bounds at the nodes 0 … nodes - 1 of every axis, addressed by a flat index (slot · 8³ + local).

    bounds: (p, q) of every address; replaced when the store grows.
    """

    def __init__(self, nodes: tuple[int, int, int], device: torch.device) -> None:
        # a layer of bricks that never exist around those that may
        x, y, z = (-(-count // SIDE) + 2 for count in nodes)
        self._strides = (y * z, z, 1)
        self._table = torch.zeros(x * y * z, dtype=torch.int32, device=device)
        self._corners = torch.zeros((3, 1), dtype=torch.int32, device=device)
        self.bounds = torch.full((2, VOLUME), -torch.inf, device=device)

    def __len__(self) -> int:
        """Number of slots, with that of the brick of which nothing is known."""
        return self._corners.shape[1]

    def slots(self, size: int) -> list[Int32[Tensor, " b"]]:
        """The slots of all bricks, in order, so many at once."""
        return list(torch.arange(1, len(self), dtype=torch.int32, device=self._corners.device).split(size))

    def firsts(self, slots: Int32[Tensor, " b"]) -> Int32[Tensor, "3 b"]:
        """The lowest nodes of bricks."""
        return self._corners.index_select(1, slots) * SIDE

    def find(self, nodes: Int32[Tensor, "3 n"]) -> Int32[Tensor, " n"]:
        """Addresses of nodes; those in slot 0, below 8³, are not stored."""
        x, y, z = nodes
        address = self._table.index_select(0, self._keys(nodes)).bitwise_left_shift_(9)
        return address.add_((x & 7) << 6).add_((y & 7) << 3).add_(z & 7)

    def nodes(self, addresses: Int32[Tensor, " n"]) -> Int32[Tensor, "3 n"]:
        """The inverse of find."""
        first = self._corners.index_select(1, addresses >> 9).mul_(SIDE)
        first[0].add_(addresses >> 6 & 7)
        first[1].add_(addresses >> 3 & 7)
        first[2].add_(addresses & 7)
        return first

    def block(self, firsts: Int32[Tensor, "3 b"], side: int) -> Int32[Tensor, " b*{side}*{side}*{side}"]:
        """Addresses of the side³ nodes from each of the firsts on, the last axis fastest."""
        along = firsts[:, :, None] + torch.arange(side, dtype=torch.int32, device=firsts.device)
        far, near = (along >> 3) + 1, along & 7
        x, y, z = (part * stride for part, stride in zip(far, self._strides, strict=True))
        key = ((x[:, :, None] + y[:, None, :])[..., None] + z[:, None, None, :]).view(-1)
        x, y, z = near[0] << 6, near[1] << 3, near[2]
        local = (x[:, :, None] + y[:, None, :])[..., None] + z[:, None, None, :]
        return self._table.index_select(0, key).bitwise_left_shift_(9).add_(local.view(-1))

    def at(self, addresses: Int32[Tensor, " n"]) -> Float32[Tensor, "2 n"]:
        """Bounds."""
        return torch.stack([bound.index_select(0, addresses) for bound in self.bounds])

    def exact(self, addresses: Int32[Tensor, " n"]) -> Bool[Tensor, " n"]:
        """Where the value was evaluated."""
        low, negative = self.at(addresses)
        return low == -negative

    def sides(self, addresses: Int32[Tensor, " n"]) -> UInt8[Tensor, " n"]:
        """OUTSIDE, INSIDE or UNKNOWN."""
        return sides(self.at(addresses))

    def assign(self, addresses: Int32[Tensor, " n"], values: Float32[Tensor, " n"]) -> None:
        """Store evaluated values."""
        self.bounds[0, addresses] = values
        self.bounds[1, addresses] = -values

    def cover(self, nodes: Int32[Tensor, "3 n"]) -> None:
        """Make the bricks of nodes that do not exist; `grow` then makes room for what is known in them."""
        keys = self._keys(nodes)
        keys = torch.unique(keys[self._table.index_select(0, keys) == 0])
        count = len(self)
        slots = torch.arange(count, count + len(keys), dtype=torch.int32, device=keys.device)
        self._table[keys] = slots
        x, y, _ = self._strides
        fresh = torch.stack([keys // x, keys % x // y, keys % y]) - 1
        self._corners = torch.cat([self._corners, fresh], dim=1)

    def cover_cells(self, nodes: Int32[Tensor, "3 n"]) -> None:
        """Make the bricks of the 27 nodes of cells of side 2 with these lowest nodes, which are even."""
        for offset in itertools.product((0, 2), repeat=3):
            # the nodes between are in the brick of the even one below
            self.cover(nodes + torch.tensor(offset, dtype=torch.int32, device=nodes.device)[:, None])

    def grow(self) -> None:
        """Room for every brick; nothing is known in new ones."""
        missing = len(self) * VOLUME - self.bounds.shape[1]
        if missing > 0:
            self.bounds = torch.nn.functional.pad(self.bounds, (0, missing), value=-torch.inf)

    def _keys(self, nodes: Int32[Tensor, "3 n"]) -> Int32[Tensor, " n"]:
        """Places in the table."""
        x, y, z = (axis * stride for axis, stride in zip((nodes >> 3) + 1, self._strides, strict=True))
        return x.add_(y).add_(z)


def sides(bounds: Float32[Tensor, "2 n"]) -> UInt8[Tensor, " n"]:
    """OUTSIDE, INSIDE or UNKNOWN by bounds."""
    outside, inside = (bounds > 0).to(torch.uint8)
    known = outside ^ inside
    return (outside + 2 * inside) * known + UNKNOWN * (1 - known)

"""A sparse store of what is known about the field at lattice nodes: an interval for every stored node.

Nodes live in bricks of 8³; a small table maps a brick's coordinates to its slot, so that finding a node
costs a few integer operations. A brick exists only where somebody asked for one of its nodes. An interval
[low, high] bounds the field's value: low = high is a value that was evaluated, low > 0 a node that is
surely outside, high < 0 one that is surely inside, (-∞, ∞) a node of which nothing is known. Bounds that
contradict each other (low > 0 > high: the field was steeper than assumed) say nothing either.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float32, Int, Int8

SIDE = 8
VOLUME = SIDE**3
_BATCH = 2048


class Bricks:
    """Intervals at the nodes 0 … nodes - 1 of every axis, addressed by a flat index (slot · 8³ + local).

    low, high: the two ends of the interval of every address; they are replaced when the store grows.
    """

    def __init__(self, nodes: tuple[int, int, int]) -> None:
        x, y, z = (-(-count // SIDE) for count in nodes)
        self._table = np.full((x, y, z), -1, dtype=np.int32)
        self._corners = np.empty((0, 3), dtype=np.int32)
        self.low = np.empty(0, dtype=np.float32)
        self.high = np.empty(0, dtype=np.float32)

    def __len__(self) -> int:
        """Number of bricks."""
        return len(self._corners)

    def find(self, nodes: Int[np.ndarray, "n 3"]) -> Int[np.ndarray, " n"]:
        """Addresses of nodes; negative where the brick does not exist."""
        x, y, z = nodes[:, 0], nodes[:, 1], nodes[:, 2]
        _, ny, nz = self._table.shape
        slot = self._table.ravel()[((x >> 3) * ny + (y >> 3)) * nz + (z >> 3)]
        return slot * VOLUME + (((x & 7) << 6) | ((y & 7) << 3) | (z & 7))

    def locate(self, nodes: Int[np.ndarray, "n 3"]) -> Int[np.ndarray, " n"]:
        """Addresses of nodes; bricks that do not exist are made, with nothing known in them."""
        found = self.find(nodes)
        missing = found < 0
        if missing.any():
            self._add(nodes[missing] >> 3)
            found[missing] = self.find(nodes[missing])
        return found

    def nodes(self, addresses: Int[np.ndarray, " n"]) -> Int[np.ndarray, "n 3"]:
        """The inverse of find."""
        local = addresses & (VOLUME - 1)
        inside = np.stack([local >> 6, (local >> 3) & 7, local & 7], axis=1)
        return self._corners[addresses >> 9] * SIDE + inside.astype(np.int32)

    def exact(self, addresses: Int[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
        """Where the value was evaluated."""
        return self.low[addresses] == self.high[addresses]

    def signs(self, nodes: Int[np.ndarray, "n 3"]) -> Int8[np.ndarray, " n"]:
        """-1 inside, 1 outside, 0 not known."""
        found = self.find(nodes)
        stored = found >= 0
        found = np.where(stored, found, 0)
        signs = (self.low[found] > 0).astype(np.int8) - (self.high[found] < 0).astype(np.int8)
        return np.where(stored, signs, np.int8(0))

    def assign(self, addresses: Int[np.ndarray, " n"], values: Float32[np.ndarray, " n"]) -> None:
        """Store evaluated values."""
        self.low[addresses] = values
        self.high[addresses] = values

    def padded_signs(self) -> Iterator[tuple[Int[np.ndarray, "b 3"], Int8[np.ndarray, "b 9 9 9"]]]:
        """For batches of bricks: their first nodes, and the signs of their nodes and one layer above."""
        x, y, z = self._table.shape
        table = np.full((x + 1, y + 1, z + 1), -1, dtype=np.int32)
        table[:x, :y, :z] = self._table
        used = len(self) * VOLUME
        signs = (self.low[:used] > 0).astype(np.int8) - (self.high[:used] < 0).astype(np.int8)
        blocks = np.zeros((len(self) + 1, SIDE, SIDE, SIDE), dtype=np.int8)
        blocks[:-1] = signs.reshape(-1, SIDE, SIDE, SIDE)
        part = (slice(0, SIDE), slice(0, 1))
        place = (slice(0, SIDE), slice(SIDE, SIDE + 1))
        for start in range(0, len(self), _BATCH):
            corners = self._corners[start : start + _BATCH]
            padded = np.empty((len(corners), SIDE + 1, SIDE + 1, SIDE + 1), dtype=np.int8)
            for a, b, c in np.ndindex(2, 2, 2):
                slots = table[corners[:, 0] + a, corners[:, 1] + b, corners[:, 2] + c]
                padded[:, place[a], place[b], place[c]] = blocks[slots][:, part[a], part[b], part[c]]
            yield corners * SIDE, padded

    def _add(self, corners: Int[np.ndarray, "n 3"]) -> None:
        _, ny, nz = self._table.shape
        keys = np.unique((corners[:, 0] * ny + corners[:, 1]) * nz + corners[:, 2])
        self._table.ravel()[keys] = len(self) + np.arange(len(keys), dtype=np.int32)
        fresh = np.stack([keys // (ny * nz), keys // nz % ny, keys % nz], axis=1).astype(np.int32)
        self._corners = np.concatenate([self._corners, fresh])
        if len(self) * VOLUME > len(self.low):
            spare = np.full((len(self) + len(self) // 2) * VOLUME - len(self.low), np.inf, dtype=np.float32)
            self.low = np.concatenate([self.low, -spare])
            self.high = np.concatenate([self.high, spare])

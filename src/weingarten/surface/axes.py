"""What depends on one coordinate of a node alone, in tables: its position, and the field of the box.

The field of the box is −L·depth, depth the length from a node to the nearest side: the largest of three
functions of a coordinate each. It is just above 0 on the sides themselves and beyond.
"""

import numpy as np
import torch
from jaxtyping import Float32, Int32
from torch import Tensor

from weingarten.surface.lattice import Lattice


class Axes:
    """Tables over the nodes 0 … length - 1 of every axis, of the lattice's own stride.

    lattice: where the nodes lie.
    slope: L, field units per unit of length.
    small: the least positive value, field units.
    """

    def __init__(
        self, lattice: Lattice, slope: float, small: float, length: int, device: torch.device
    ) -> None:
        nodes = np.arange(length, dtype=np.int32)
        positions = np.stack([low + lattice.step * nodes for low in lattice.lower])
        depth = np.stack([np.minimum(nodes, cells - nodes) for cells in lattice.cells])
        box = (-slope * lattice.step * depth).astype(np.float32)
        box = np.where(depth <= 0, np.maximum(box, np.float32(small)), box)
        self._positions = torch.from_numpy(positions.astype(np.float32)).to(device)
        self._box = torch.from_numpy(box).to(device)

    def positions(self, nodes: Int32[Tensor, "3 n"]) -> Float32[Tensor, "n 3"]:
        """Positions in the unit frame."""
        axes = zip(self._positions, nodes, strict=True)
        return torch.stack([table.index_select(0, node) for table, node in axes], dim=1)

    def box(self, nodes: Int32[Tensor, "3 n"]) -> Float32[Tensor, " n"]:
        """The field of the box, which the closed field never falls below."""
        x, y, z = (table.index_select(0, node) for table, node in zip(self._box, nodes, strict=True))
        return x.maximum(y).maximum(z)

    def box_of_blocks(
        self, firsts: Int32[Tensor, "3 b"], side: int, stride: int
    ) -> Float32[Tensor, "b {side} {side} {side}"]:
        """The field of the box at the side³ nodes from each of the firsts on, by steps of the stride."""
        nodes = firsts[:, :, None] + stride * torch.arange(side, dtype=torch.int32, device=firsts.device)
        x, y, z = (table[node] for table, node in zip(self._box, nodes, strict=True))
        return x[:, :, None].maximum(y[:, None, :])[..., None].maximum(z[:, None, None, :])

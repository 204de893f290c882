"""The lattice of cubic cells laid over a box: counts, positions, depth. It holds no field values."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Num

from weingarten.errors import OptionError


@dataclass(frozen=True)
class Lattice:
    """Node (i, j, k) lies at lower + step · (i, j, k); the box's nodes run from 0 to cells on every axis.

    lower: lowest corner of the box, unit frame.
    step: side h of a cell, unit frame.
    cells: number of cells along x, y, z; the last cell of an axis may reach beyond the box by less than h.
    """

    lower: tuple[float, float, float]
    step: float
    cells: tuple[int, int, int]

    @classmethod
    def over(
        cls, lower: Float64[np.ndarray, " 3"], upper: Float64[np.ndarray, " 3"], resolution: int
    ) -> "Lattice":
        """Cubes of side (longest side / resolution) over a box.

        Raises OptionError for an empty box or a resolution below 2.
        """
        sides = upper - lower
        if not np.isfinite(sides).all() or not (sides > 0).all():
            raise OptionError(
                f"The extraction box from {lower.tolist()} to {upper.tolist()} is empty: give finite "
                "corners, the upper one above the lower one on every axis."
            )
        if resolution < 2:
            raise OptionError(f"The resolution {resolution} is too low: give at least 2 cells.")
        step = float(sides.max()) / resolution
        x, y, z = (max(1, math.ceil(side / step - 1e-6)) for side in sides.tolist())
        return cls((float(lower[0]), float(lower[1]), float(lower[2])), step, (x, y, z))

    def positions(self, nodes: Num[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
        """Node indices, or places between them, to positions in the unit frame."""
        return np.asarray(self.lower) + self.step * nodes

    def places(self, positions: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
        """The inverse of positions."""
        return (positions - np.asarray(self.lower)) / self.step

    def depths(self, nodes: Num[np.ndarray, "n 3"]) -> Num[np.ndarray, " n"]:
        """Cells between a node and the nearest side of the box: 0 on a side, negative beyond."""
        x, y, z = nodes[:, 0], nodes[:, 1], nodes[:, 2]
        depth = np.minimum(x, self.cells[0] - x)
        depth = np.minimum(depth, np.minimum(y, self.cells[1] - y))
        return np.minimum(depth, np.minimum(z, self.cells[2] - z))

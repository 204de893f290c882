"""How fine a lattice a part asks for: between two sheets that are closer than CELLS cells, it tears holes.

Marching cubes and dual contouring see a wall only where lattice nodes lie within it, and of a wall of one
cell many do not.
"""

import math

CELLS = 2.5
"""Between two sheets."""

FINEST = 2
"""Times as fine at most: the time of an extraction is as the square."""


def cells_along(resolution: int, longest: float, apart: float) -> int:
    """Cells along a box's longest side: resolution, or up to FINEST times as many where sheets are close.

    longest: side of the box. apart: distance of the closest sheets (`weingarten.scan.sheets.Sheets.apart`),
    in the same unit, above 0.
    """
    return max(resolution, min(FINEST * resolution, math.ceil(CELLS * longest / apart)))

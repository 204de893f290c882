"""Points that are exactly the same, found by sorting: memory grows linearly with the number of points."""

import numpy as np
from jaxtyping import Float64, Int64

Points = Float64[np.ndarray, "n 3"]


def coincident(points: Points) -> tuple[Int64[np.ndarray, " m"], Int64[np.ndarray, " n"]]:
    """`first` and `inverse`: points[first] are distinct, in order of first occurrence, and
    points[first][inverse] equals points.

    Zeros of either sign are the same; a row with NaN equals no other.
    """
    # lexsort is stable: of equal rows the one that came first stays first
    order = np.lexsort((points[:, 2], points[:, 1], points[:, 0]))
    starts = np.ones(len(points), dtype=bool)
    starts[1:] = False
    for axis in range(3):
        column = points[order, axis]
        starts[1:] |= column[1:] != column[:-1]
    leaders = order[starts]
    rank = np.empty(len(leaders), dtype=np.int64)
    by_occurrence = np.argsort(leaders)
    rank[by_occurrence] = np.arange(len(leaders))
    inverse = np.empty(len(points), dtype=np.int64)
    inverse[order] = rank[np.cumsum(starts) - 1]
    return leaders[by_occurrence].astype(np.int64), inverse

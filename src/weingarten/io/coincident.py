"""Points that are exactly the same, found by sorting: memory grows linearly with the number of points."""

import numpy as np
from jaxtyping import Float64, Int64, UInt64

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


def distinct(points: Points) -> Int64[np.ndarray, " m"]:
    """`coincident(points)[0]`, the first one of all that are equal, ten times as fast where few are.

    Equal points have equal keys, so only those that share theirs are compared by their coordinates.
    """
    key = keys(points)
    order = np.argsort(key)
    shared = key[order[1:]] == key[order[:-1]]
    doubtful = np.zeros(len(points), dtype=bool)
    doubtful[order[1:][shared]] = True
    doubtful[order[:-1][shared]] = True
    index = np.flatnonzero(doubtful)
    doubtful[index[coincident(points[index])[0]]] = False
    return np.flatnonzero(~doubtful)


def keys(points: Points) -> UInt64[np.ndarray, " n"]:
    """A number of 64 bits for every point, the same for equal points and hardly ever for others.

    Every step on the way, exclusive or, product with an odd number, and shift, can be undone, so points that
    differ in the last coordinate alone never share one.
    """
    key = np.zeros(len(points), dtype=np.uint64)
    for axis in range(3):
        key ^= (points[:, axis] + 0.0).view(np.uint64)  # −0 + 0 = 0
        key *= np.uint64(0x9E3779B97F4A7C15)
        key ^= key >> np.uint64(32)
    return key

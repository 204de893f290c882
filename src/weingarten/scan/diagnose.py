"""What is wrong with a cloud: told before a fit is tried, and mended where nothing is lost by it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from weingarten.errors import CloudError
from weingarten.io.coincident import distinct

Points = Float64[np.ndarray, "n 3"]

LEAST_POINTS = 100
MOST_NOT_FINITE = 0.01
FLATNESS = 1e-6
_ROUNDINGS = 4.0
_BLOCK = 100_000


@dataclass(frozen=True)
class Diagnosis:
    """A cloud fit for use, in world units, and one note for each thing that was mended."""

    points: Points
    notes: tuple[str, ...]


def diagnose(points: Float64[np.ndarray, "..."]) -> Diagnosis:
    """The finite, distinct points in their given order.

    Less than 1 % of rows that are not finite are dropped, and exact duplicates merged, each with a note.
    Flatness is judged by the standard deviations along the principal axes, s₁ ≥ s₂ ≥ s₃: the singular
    values of the centred points over √n. One counts as zero below

        max(10⁻⁶ s₁, 4 ε max|x|),   ε = 2⁻⁵²,

    where the first absorbs coordinates that were rounded to single precision and the second those that
    were rounded to double precision at a large offset.

    Raises CloudError for a wrong shape, 1 % or more not finite, fewer than 100 distinct points, or points
    that are all identical, on one line or in one plane.
    """
    if points.ndim != 2 or points.shape[1] != 3:
        raise CloudError(f"The points have shape {points.shape}; give an array of shape (n, 3).")
    points, notes = _finite(np.asarray(points, dtype=np.float64))
    given = len(points)
    first = distinct(points)
    if len(first) < given:
        notes += (f"{given - len(first)} of {given} points repeat another exactly; merged.",)
        points = points[first]
    check_spread(points, given)
    return Diagnosis(points, notes)


def _finite(points: Points) -> tuple[Float64[np.ndarray, "m 3"], tuple[str, ...]]:
    """The finite rows, and a note if that left some out."""
    finite = np.isfinite(points).all(axis=1)
    dropped = len(points) - int(np.count_nonzero(finite))
    if dropped == 0:
        return points, ()
    if dropped >= MOST_NOT_FINITE * len(points):
        raise CloudError(
            f"{dropped} of {len(points)} points are not finite; remove those rows and try again."
        )
    return points[finite], (f"{dropped} of {len(points)} points are not finite; dropped.",)


def check_spread(points: Points, given: int, which: str = "points") -> None:
    """Raise CloudError unless the distinct ones of the `given` points are enough and fill space.

    which: what the error calls them.
    """
    n = len(points)
    if n == 1 and given > 1:
        raise CloudError(f"All {given} points are identical; check the columns and the export of the scan.")
    if n < LEAST_POINTS:
        raise CloudError(f"The cloud has {n} distinct points; give at least {LEAST_POINTS}.")
    dimensions = _dimensions(points)
    if dimensions == 0:
        raise CloudError(f"All {n} {which} are identical up to rounding; check the scan's unit and offset.")
    if dimensions < 3:
        shape = "on one line" if dimensions == 1 else "in one plane"
        raise CloudError(f"All {n} {which} lie {shape}; a part needs points on all of its sides.")


def _dimensions(points: Points) -> int:
    """How many principal standard deviations are not zero to within rounding (see `diagnose`)."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle = low / 2 + high / 2
    size = float(np.maximum(high - middle, middle - low).max())
    if size == 0.0:
        return 0
    deviations = _deviations(points, middle, size)
    rounding = _ROUNDINGS * np.finfo(np.float64).eps * max(np.abs(low).max(), np.abs(high).max()) / size
    return int(np.count_nonzero(deviations > max(FLATNESS * deviations[0], rounding)))


def _deviations(points: Points, middle: Float64[np.ndarray, " 3"], size: float) -> Float64[np.ndarray, " 3"]:
    """Principal standard deviations of (points − middle) / size, the largest first.

    The triangular factor of [1 | X] ends in that of the centred X, and that of two blocks of rows is that of
    their factors, so nothing as large as the cloud is made.
    """
    triangular = np.empty((0, 4))
    for start in range(0, len(points), _BLOCK):
        block = (points[start : start + _BLOCK] - middle) / size
        rows = np.column_stack([np.ones(len(block)), block])
        triangular = np.asarray(np.linalg.qr(np.concatenate([triangular, rows]), mode="r"))
    return np.linalg.svd(triangular[1:, 1:], compute_uv=False) / np.sqrt(len(points))

"""What is done about a scan's outliers and noise before a fit draws from it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64
from scipy.spatial import KDTree

from weingarten.errors import CloudError
from weingarten.scan.diagnose import LEAST_POINTS, check_spread
from weingarten.scan.noise import Noise, noise_of
from weingarten.scan.outliers import outliers
from weingarten.scan.settled import Settled, settled

Points = Float64[np.ndarray, "n 3"]


def none(points: Points, seed: int) -> Bool[np.ndarray, " n"]:
    """No point is an outlier."""
    return np.zeros(len(points), dtype=bool)


def as_given(points: Points) -> Settled:
    """Points as they are, whatever their noise."""
    return Settled(points, Noise())


def by_their_noise(points: Points) -> Settled:
    """Points moved towards their surface as far as their noise tells."""
    return settled(points, noise_of(points, KDTree(points)))


@dataclass(frozen=True)
class Preparation:
    """outliers: which points of a cloud are, in any frame, by a seed. settle: the others, unit frame."""

    outliers: Callable[[Points, int], Bool[np.ndarray, " n"]]
    settle: Callable[[Points], Settled]

    def cleaned(self, points: Points, seed: int) -> tuple[Float64[np.ndarray, "m 3"], tuple[str, ...]]:
        """The points that are no outliers, and a note if some are.

        Raises CloudError where few or flat ones are left.
        """
        found = self.outliers(points, seed)
        count = int(np.count_nonzero(found))
        if not count:
            return points, ()
        if len(points) - count < LEAST_POINTS:
            raise CloudError(
                f"{count} of {len(points)} points belong to no surface; scan the part more densely."
            )
        check_spread(points[~found], len(points) - count, "points that are no outliers")
        said = f"{count:,} of {len(points):,} points ({100.0 * count / len(points):.2g} %)"
        said = f"Left out as outliers, which belong to no surface: {said}."
        return points[~found], (said,)


AS_GIVEN = Preparation(none, as_given)
AS_SCANNED = Preparation(outliers, by_their_noise)
"""For published methods, which take the points as they are; for ours."""

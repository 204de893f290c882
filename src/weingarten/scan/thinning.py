"""The part of a large cloud that a fit draws from.

A fit of the `standard` preset makes some 800,000 draws on the surface: it cannot see ten million points. But
neighbours, free space and the draws themselves cost time and memory for every point that might be seen.
"""

import numpy as np
from jaxtyping import Float64

from weingarten.scan.sampling import generator

MOST_POINTS = 400_000
"""Of more points so many are drawn from. With noise, 200,000 gave a little worse a fit than a million did,
and so many did not (docs/performance.md)."""

STREAM = 2
"""What sets these random numbers apart from others of the same seed."""


def thinned(points: Float64[np.ndarray, "n 3"], seed: int) -> Float64[np.ndarray, "m 3"]:
    """MOST_POINTS of the points, every subset as likely as any other, in their given order.

    A cloud that has no more is returned as it is. The same cloud and seed give the same points, so nothing of
    the choice needs to be kept.
    """
    if len(points) <= MOST_POINTS:
        return points
    chosen = generator((seed, STREAM)).choice(len(points), MOST_POINTS, replace=False, shuffle=False)
    return points[np.sort(chosen)]


def thinning_notes(given: int, used: int) -> tuple[str, ...]:
    """What the user should know of it."""
    if used == given:
        return ()
    return (
        f"The fit draws from {used:,} of the {given:,} points, picked at random; distances to the mesh are "
        "of points picked from all.",
    )

"""Orthogonal least squares on points, with those left out that are none of the surface's."""

from typing import TypeVar

import numpy as np
from scipy.optimize import least_squares

from weingarten.measure.surface import Points, Surface, Values

AnySurface = TypeVar("AnySurface", bound=Surface)

ROUNDS, FAR = 4, 4.5
"""Points further from a surface than FAR times the median distance are left out of the next round."""

EVALUATIONS, CLOSE = 40, 1e-9
"""Of residuals at most, for one fit; and the relative change at which it ends."""


def fitted(surface: AnySurface, points: Points, floor: float, rounds: int = ROUNDS) -> AnySurface | None:
    """min Σ d² over the points that are near, from a surface that is nearly right; None where that fails.

    floor: distance within which no point is left out.
    """
    for _ in range(rounds):
        distance = np.abs(surface.distance(points))
        near = points[distance <= max(FAR * float(np.median(distance)), floor)]
        better = least(surface, near)
        if better is None:
            return None
        surface = better
        if len(near) == len(points):
            break
    return surface


def least(surface: AnySurface, points: Points) -> AnySurface | None:
    """min Σ d² over all points (Levenberg and Marquardt, by MINPACK)."""
    if len(points) <= surface.FREEDOM:
        return None
    surface = surface.centred(points)

    def residuals(step: Values) -> Values:
        return surface.moved(step).distance(points)

    start = np.zeros(surface.FREEDOM)
    if not np.isfinite(residuals(start)).all():
        return None
    found = least_squares(residuals, start, method="lm", ftol=CLOSE, xtol=CLOSE, max_nfev=EVALUATIONS)
    return surface.moved(found.x) if np.isfinite(found.x).all() else None

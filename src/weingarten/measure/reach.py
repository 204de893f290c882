"""How far a surface reaches, told from the points on it."""

import numpy as np

from weingarten.measure.surface import Values

GAP = 2.0
"""A gap is one if it is so many times as wide as chance leaves it, or CLOSED."""

CLOSED = np.radians(4.0)


def swept(angles: Values) -> tuple[float, bool]:
    """Degrees that are left beside the widest gap between angles (radians), and whether they are all of 360.

    n angles at random leave a widest gap of about 2π ln n / n.
    """
    count = len(angles)
    if count < 3:
        return 0.0, False
    ordered = np.sort(angles)
    gap = float(np.diff(ordered, append=ordered[0] + 2.0 * np.pi).max())
    whole = bool(gap <= max(CLOSED, GAP * 2.0 * np.pi * np.log(count) / count))
    return (360.0 if whole else 360.0 - float(np.degrees(gap))), whole


def beyond(count: int) -> float:
    """By what factor an interval is longer than that between the outermost of n points at random in it.

    (n + 1)/(n − 1): the estimate of the least variance that is right on average.
    """
    return (count + 1.0) / max(count - 1.0, 1.0)


def spanned(heights: Values) -> float:
    """The length of the interval that the heights are from."""
    return float(np.ptp(heights)) * beyond(len(heights))

"""Orthogonal least squares on points, with those left out that are none of the surface's."""

import numpy as np

from weingarten.measure.surface import Points, Surface

ROUNDS, FAR = 4, 4.5
"""Points further from a surface than FAR times the median distance are left out of the next round."""

STEPS, CLOSE, EXACT = 15, 1e-4, 1e-13
"""At most; the relative change of Σ d² at which a fit ends; and the residual, unit lengths."""

DAMPING, MOST_DAMPING, SINGULAR = 1e-3, 1e6, 1e-12
"""λ at first and in the end, and what is as good as zero in the normal equations."""


def fitted(surface: Surface, points: Points, floor: float, rounds: int = ROUNDS) -> Surface | None:
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


def least(surface: Surface, points: Points) -> Surface | None:
    """min Σ d² over all points: Gauss and Newton's steps, damped as Levenberg and Marquardt do.

    Every step is taken in coordinates about the surface that the last one led to, so that no direction of an
    axis is singular. None where there are too few points, or the surface leaves the realm of numbers.
    """
    if len(points) <= surface.FREEDOM:
        return None
    surface = surface.centred(points)
    distance, damping = surface.distance(points), DAMPING
    error = float(distance @ distance)
    for _ in range(STEPS):
        slopes = surface.slopes(points)
        normal, right = slopes.T @ slopes, slopes.T @ distance
        if not (np.isfinite(normal).all() and np.isfinite(right).all()):
            return None
        scale = np.sqrt(np.maximum(np.diag(normal), SINGULAR * len(points)))
        damped = normal / np.outer(scale, scale) + damping * np.eye(len(scale))
        step = -np.linalg.lstsq(damped, right / scale, rcond=SINGULAR)[0] / scale
        tried = surface.moved(step)
        away = tried.distance(points)
        better = float(away @ away)
        if not better < error:
            if damping > MOST_DAMPING:
                break
            damping *= 10.0
            continue
        ended = error - better <= CLOSE * error
        surface, distance, error, damping = tried, away, better, max(0.1 * damping, SINGULAR)
        if ended or error <= EXACT**2 * len(points):
            break
    return surface

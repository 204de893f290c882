"""Points that belong to no surface: before a part, within it, or beside it.

A point is an outlier when its neighbours leave it alone: it is far from the plane through them, or from their
mean, as their neighbourhoods are not; or it is far from everything.
"""

import numpy as np
from jaxtyping import Bool, Float64
from scipy.spatial import KDTree

from weingarten.scan.noise import noise_of
from weingarten.scan.normals import least_planes
from weingarten.scan.thinning import thinned

Points = Float64[np.ndarray, "n 3"]

NEIGHBOURS = 12

ASIDE, LONELY = 0.55, 1.2
"""An outlier is so far aside of its neighbours, in radii of its neighbourhood, which is so many times as
large as theirs: on a plane, the second is 1 and the first 0."""

NOISE = 3.0
"""Standard deviations of the noise that are allowed beside that."""

DESERTED, SOLID = 2.5, 0.1
"""Or its neighbourhood is so many times as large as the median, and no plane: ratio of smaller variances."""

FEW = 0.002
"""Share of outliers up to which the planes decide; with more, the means do too, which edges look like."""

MOST_ROUNDS = 4
"""Outliers among a point's neighbours conceal that it is one."""


def outliers(points: Points, seed: int) -> Bool[np.ndarray, " n"]:
    """Which points are, in any frame.

    Of very many, some are judged (`weingarten.scan.thinning`). Where some of those are outliers, so are all
    points that are farther from the nearest of the rest than its own NEIGHBOURS are.
    """
    judged = thinned(points, seed)
    found = lost(judged)
    if len(judged) == len(points):
        return found
    if not found.any():
        return np.zeros(len(points), dtype=bool)
    kept = judged[~found]
    tree = KDTree(kept)
    radius = np.asarray(tree.query(kept, k=NEIGHBOURS + 1, workers=-1)[0])[:, -1]
    gap, nearest = tree.query(points, workers=-1)
    return gap > radius[nearest]


def lost(points: Points) -> Bool[np.ndarray, " n"]:
    """Which points are outliers."""
    kept = np.arange(len(points))
    allowed = NOISE * noise_of(points, KDTree(points)).level
    for _ in range(MOST_ROUNDS):
        if len(kept) <= NEIGHBOURS:
            break
        by_planes, by_means = aside(points[kept], allowed)
        many = len(points) - len(kept) + np.count_nonzero(by_planes) > FEW * len(points)
        found = by_means if many else by_planes
        if not found.any():
            break
        kept = kept[~found]
    result = np.ones(len(points), dtype=bool)
    result[kept] = False
    return result


def aside(points: Points, allowed: float) -> tuple[Bool[np.ndarray, " n"], Bool[np.ndarray, " n"]]:
    """Which points are outliers by the planes through their neighbours, and which by their means."""
    reach, near = KDTree(points).query(points, k=NEIGHBOURS + 1, workers=-1)
    radius, near = np.asarray(reach)[:, -1], np.asarray(near)[:, 1:]
    planes = least_planes(points[near])
    way = points - planes.centres
    off_plane = np.abs(np.einsum("nd,nd->n", way, planes.normals))
    off_mean = np.linalg.norm(way, axis=1)
    alone = radius > LONELY * np.median(radius[near], axis=1)
    solid = planes.variances[:, 0] > SOLID * planes.variances[:, 1]
    deserted = (radius > DESERTED * np.median(radius)) & solid
    far = ASIDE * radius + allowed
    return (alone & (off_plane > far)) | deserted, (alone & (off_mean > far)) | deserted

"""Where a cloud ends though its surface does not: rims of holes in the scan and of open sheets.

About a point within a surface its neighbours lie all round; about one on a rim there is a gap. In the plane
of least squares through its NEIGHBOURS, a point is on a rim when nothing lies within GAP of angle and its
neighbourhood is FLAT, which that of a closed surface's sharp edge or of a thin wall's rim is not: their other
side is among the neighbours. By chance a gap of that width is there with probability
(NEIGHBOURS) (1 − GAP / 2π)^(NEIGHBOURS − 1) = 9e-5, and chance makes no chains: only chains of LEAST such
points count, whose links are neighbours of each other.
"""

import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from weingarten.scan.normals import least_planes

Points = Float64[np.ndarray, "n 3"]

NEIGHBOURS = 30
GAP = 2.2
"""Radians, 126 degrees; on a straight rim it is 180, inside of a corner of the rim 90 or more."""

FLAT = 0.03
"""Greatest ratio of a neighbourhood's two smaller variances."""

LEAST = 5
"""Points of a chain."""

MOST_POINTS = 50_000
"""Of more, so many are looked at, picked at random."""


def rims(points: Points, seed: int = 0) -> tuple[Int64[np.ndarray, " _"], ...]:
    """Numbers of the points on each rim of a cloud, in any frame, the longest rim first."""
    asked = np.arange(len(points))
    if len(points) > MOST_POINTS:
        asked = np.random.default_rng(seed).choice(len(points), MOST_POINTS, replace=False)
        points = points[asked]
    if len(points) <= NEIGHBOURS:
        return ()
    near = np.asarray(KDTree(points).query(points, k=NEIGHBOURS + 1, workers=-1)[1])[:, 1:]
    chains = chained(on_rim(points, near), near)
    return tuple(asked[chain] for chain in chains if len(chain) >= LEAST)


def on_rim(points: Points, near: Int64[np.ndarray, "n k"]) -> Bool[np.ndarray, " n"]:
    """Which points have a gap among their neighbours."""
    planes = least_planes(points[near])
    flat = planes.variances[:, 0] < FLAT * planes.variances[:, 1]
    normals, own = planes.normals[flat], np.flatnonzero(flat)
    across = np.cross(normals, np.eye(3)[np.abs(normals).argmin(axis=1)])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    way = points[near[own]] - points[own][:, None]
    along = np.einsum("nkd,nd->nk", way, np.cross(normals, across))
    angle = np.sort(np.arctan2(along, np.einsum("nkd,nd->nk", way, across)), axis=1)
    gap = np.diff(angle, axis=1, append=angle[:, :1] + 2.0 * np.pi).max(axis=1)
    found = np.zeros(len(points), dtype=bool)
    found[own[gap > GAP]] = True
    return found


def chained(marked: Bool[np.ndarray, " n"], near: Int64[np.ndarray, "n k"]) -> list[Int64[np.ndarray, " _"]]:
    """Numbers of the marked points, by chains of neighbours, the longest first."""
    own = np.flatnonzero(marked)
    if not len(own):
        return []
    place = np.full(len(marked), -1)
    place[own] = np.arange(len(own))
    linked = place[near[own]]
    row, column = np.nonzero(linked >= 0)
    graph = coo_matrix((np.ones(len(row)), (row, linked[row, column])), shape=(len(own), len(own)))
    count, label = connected_components(graph, directed=False)
    chains = [own[label == number] for number in range(count)]
    return sorted(chains, key=len, reverse=True)

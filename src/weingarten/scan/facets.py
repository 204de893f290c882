"""The plane that a point shares with its neighbours where these lie in several: at edges and in thin walls.

The plane of least squares through a neighbourhood that reaches across an edge is none of the planes that meet
there. So planes through the point and pairs of its nearest neighbours are tried, and that one is taken which
has the most neighbours with it, each counted as

    exp(−(d / ε)²),   d its distance from the plane, ε = TOLERANCE r, r the radius of the neighbourhood,

fitted once more to those that it has (as RANSAC, Fischler & Bolles 1981, with every pair in the place of
random ones, and a count without a threshold, as MLESAC's, Torr & Zisserman 2000).
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float64, Int64

Points = Float64[np.ndarray, "n 3"]

PAIRED = 8
"""Nearest neighbours of which pairs are formed: 28 planes a point."""

TOLERANCE = 0.05
"""ε, in radii of the neighbourhood."""

LEAST = 5.0
"""Count of neighbours, its own pair among them, from which a plane is no coincidence: of NEIGHBOURS others at
random in the ball about a point, 0.05 · 1.5 · √π · 10 = 1.3 would lie so near to it."""

BROAD = 0.05
"""Least ratio of the two larger variances of those in a plane: points in a line are in many."""

OTHER = 0.9
"""|Cosine| below which two planes are not the same."""

RIVAL, SLACK = 0.85, 0.3
"""Share of a plane's count from which a rival leaves it no trust, as on an edge, which lies in two; and how
far below that trust is whole."""

BLOCK = 20_000


@dataclass(frozen=True)
class Facets:
    """normals: unit, of arbitrary sign. trust: from 0 to 1, how much speaks for each plane."""

    normals: Points
    trust: Float64[np.ndarray, " n"]


def facets(points: Points, near: Int64[np.ndarray, "n k"]) -> Facets:
    """Of every point; near: its neighbours, the nearest first."""
    parts = [
        facets_of(points[near[start : start + BLOCK]] - points[start : start + BLOCK, None])
        for start in range(0, len(points), BLOCK)
    ]
    return Facets(
        np.concatenate([part.normals for part in parts]), np.concatenate([part.trust for part in parts])
    )


def facets_of(ways: Float64[np.ndarray, "n k 3"]) -> Facets:
    """Of points whose neighbours lie at these ways from them."""
    radius = np.linalg.norm(ways[:, -1], axis=1)
    tolerance = np.maximum(TOLERANCE * radius, np.finfo(float).tiny)[:, None]
    tried, counts = [], []
    for one, other in combinations(range(min(PAIRED, ways.shape[1])), 2):
        normal = np.cross(ways[:, one], ways[:, other])
        size = np.linalg.norm(normal, axis=1)
        normal /= np.maximum(size, np.finfo(float).tiny)[:, None]
        count = within(ways, normal, tolerance).sum(axis=1)
        tried.append(normal)
        counts.append(np.where(size > TOLERANCE * radius**2, count, 0.0))
    normals, planes = np.stack(tried, axis=1), np.stack(counts, axis=1)
    best = normals[np.arange(len(ways)), planes.argmax(axis=1)]
    found = refined(ways, best, tolerance)
    other = np.abs(np.einsum("nhd,nd->nh", normals, found.normals)) < OTHER
    rival = np.where(other, planes, 0.0).max(axis=1)
    share = rival / np.maximum(planes.max(axis=1), 1.0)
    return Facets(found.normals, found.trust * np.clip((RIVAL - share) / SLACK, 0.0, 1.0))


def within(
    ways: Float64[np.ndarray, "n k 3"], normals: Points, tolerance: Float64[np.ndarray, "n 1"]
) -> Float64[np.ndarray, "n k"]:
    """How much each neighbour counts for a plane through the point."""
    return np.exp(-((np.einsum("nkd,nd->nk", ways, normals) / tolerance) ** 2))


def refined(
    ways: Float64[np.ndarray, "n k 3"], normals: Points, tolerance: Float64[np.ndarray, "n 1"]
) -> Facets:
    """The planes of least squares through those that each has, and what speaks for it then."""
    weight = within(ways, normals, tolerance)
    spread, directions = np.linalg.eigh(np.einsum("nk,nki,nkj->nij", weight, ways, ways))
    normals = directions[:, :, 0]
    count = within(ways, normals, tolerance).sum(axis=1)
    broad = spread[:, 1] > BROAD * spread[:, 2]
    trust = np.clip((count - LEAST) / 2.0 + 0.5, 0.0, 1.0) * broad
    return Facets(normals, trust)

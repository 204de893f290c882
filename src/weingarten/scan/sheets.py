"""Two sheets of surface closer together than points are: which of them something stands before.

Of a thin wall, the nearest point of the cloud is often on the far side. Two neighbours p and q are on two
sheets if their planes are parallel and the way between them leaves both:

    |nₚ·n_q| > PARALLEL,   |(q − p)·nₚ| and |(q − p)·n_q| > max(ACROSS |q − p|, APART r),

r the radius of the neighbourhood, which two points of one smooth sheet never are: on a circle the way leaves
the tangents at its ends by half of the angle between them. What lies between two sheets is a wall or a gap,
so their outward normals are opposite.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

Points = Float64[np.ndarray, "n 3"]

PARALLEL, ACROSS = 0.95, 0.25
"""|Cosine| of 18 degrees; sine of 14: a sheet that turns by 18 has a way that leaves it by 9."""

APART = 0.15
"""Least distance of two sheets, in radii of the neighbourhood: rounded coordinates, and noise so small that
nobody has noticed it, are no sheets."""

NOTABLE = 0.03
"""Share of the points that have to have another sheet so close. Along edges up to 0.01 seem to."""


@dataclass(frozen=True)
class Sheets:
    """points, their unit normals of arbitrary sign, and their neighbours.

    across: which of those are on another sheet.
    """

    points: Points
    normals: Points
    near: Int64[np.ndarray, "n k"]
    across: Bool[np.ndarray, "n k"]

    @classmethod
    def of(cls, points: Points, normals: Points, near: Int64[np.ndarray, "n k"]) -> "Sheets":
        """In any frame."""
        way = points[near] - points[:, None]
        length = np.linalg.norm(way, axis=-1)
        least = np.maximum(ACROSS * length, APART * length[:, -1:])
        across = np.abs(np.einsum("nd,nkd->nk", normals, normals[near])) > PARALLEL
        across &= np.abs(np.einsum("nkd,nd->nk", way, normals)) > least
        across &= np.abs(np.einsum("nkd,nkd->nk", way, normals[near])) > least
        return cls(points, normals, near, across)

    @classmethod
    def one(cls, points: Points, normals: Points, near: Int64[np.ndarray, "n k"]) -> "Sheets":
        """Nothing known of another: points that noise has scattered about one sheet look like two."""
        return cls(points, normals, near, np.zeros(near.shape, dtype=bool))

    @property
    def crowd(self) -> float:
        """Share of the points that have another sheet among their neighbours."""
        return float(np.mean(np.any(self.across, axis=1)))

    @property
    def apart(self) -> float:
        """Distance within which NOTABLE of the points have another sheet; infinite where fewer have any."""
        way = np.einsum("nkd,nd->nk", self.points[self.near] - self.points[:, None], self.normals)
        closest = np.where(self.across, np.abs(way), np.inf).min(axis=1)
        return float(np.quantile(closest, NOTABLE, method="higher"))

    def before(
        self, places: Float64[np.ndarray, "m 3"], nearest: Int64[np.ndarray, " m"]
    ) -> Int64[np.ndarray, " m"]:
        """The nearest point of each place, or where a sheet lies between the two, the nearest of that one."""
        asked = np.flatnonzero(np.any(self.across, axis=1)[nearest])
        point, at = nearest[asked], places[asked][:, None]
        other = self.near[point]
        facing, there = self.normals[other], self.points[other]
        side = np.einsum("mkd,mkd->mk", at - there, facing)
        behind = np.einsum("mkd,mkd->mk", self.points[point][:, None] - there, facing)
        gap = np.linalg.norm(at - there, axis=-1)
        gap = np.where(self.across[point] & (side * behind < 0.0), gap, np.inf)
        best = gap.argmin(axis=1)
        rows = np.arange(len(asked))
        found = nearest.copy()
        found[asked] = np.where(np.isfinite(gap[rows, best]), other[rows, best], point)
        return found

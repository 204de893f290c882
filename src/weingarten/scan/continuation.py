"""What lies beyond the rims of an open cloud, if its surfaces go on as they end.

Beyond a rim nothing was scanned, and free space leaks in. Of every point p on a rim with a trusted outward
normal n, the surface goes on in its tangent plane, outside of which h(x) = n · (x − p) > 0. Two of them meet
in a concave edge where each lies before the other's plane, else in a convex one. Where x is nearest to a rim,

    f(x) = max over i of min over j, j = i or concave with i, of hⱼ(x),

over the points of rims that are not much farther from x than the nearest: the intersection of half spaces at
a convex corner, their union at a concave one, and what the faces say pair by pair where both meet. Nothing
stands out of the cloud's bounding box. f is said only where the nearest plane alone has the same sign, and no
farther from a rim than a hole of its size reaches.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

NOTHING = np.empty(0, dtype=np.int64)

Points = Float64[np.ndarray, "n 3"]
Places = Float64[np.ndarray, "m 3"]

FEWEST, MOST = 10, 128
"""Points of rims: where there are fewer, nothing is said; at most so many are asked, evenly picked."""

KNOWN = 1.0 - 1e-6
"""Length of a normal that counts."""

NEAREST, AROUND = 1.2, 2.0
"""How much farther than the nearest point of the cloud the nearest of a rim may be, and than that the others
that are asked."""

SPAN = 2.0
"""How far from a rim anything is said, in diagonals of its box: of a hole's rim, parts may be missing."""

BLOCK = 8192
"""Places that are asked at a time."""

BEFORE = 0.05
"""Sine of the angle at least by which two points of a concave edge lie before each other's planes."""


@dataclass(frozen=True)
class Continuation:
    """tree: of the cloud. rim: of the points on rims. normals: theirs, outward, of unit length.
    spans: how far from them anything is said. concave: which pairs of them meet so. lower, upper: corners of
    the cloud's box.
    """

    tree: KDTree
    rim: KDTree
    normals: Float64[np.ndarray, "r 3"]
    spans: Float64[np.ndarray, " r"]
    concave: Bool[np.ndarray, "r r"]
    lower: Float64[np.ndarray, " 3"]
    upper: Float64[np.ndarray, " 3"]

    @classmethod
    def of(
        cls, points: Points, tree: KDTree, normals: Points, rims: tuple[Int64[np.ndarray, " _"], ...]
    ) -> "Continuation | None":
        """None where too little is known of the rims.

        tree: of the points. normals: outward, of unit length where anything goes on, else shorter. rims:
        numbers of the points on each.
        """
        spans = [np.full(len(rim), SPAN * np.linalg.norm(np.ptp(points[rim], axis=0))) for rim in rims]
        numbers, reach = np.concatenate([NOTHING, *rims]), np.concatenate([np.empty(0), *spans])
        known = np.flatnonzero(np.linalg.norm(normals[numbers], axis=1) > KNOWN)
        if len(known) < FEWEST:
            return None
        chosen = known[np.linspace(0, len(known) - 1, min(MOST, len(known))).astype(int)]
        places, ways = points[numbers[chosen]], normals[numbers[chosen]]
        apart = places[None] - places[:, None]
        height = np.einsum("ijd,id->ij", apart, ways)
        before = height > BEFORE * np.linalg.norm(apart, axis=2)
        lower, upper = points.min(axis=0), points.max(axis=0)
        return cls(tree, KDTree(places), ways, reach[chosen], before & before.T, lower, upper)

    def box(self, margin: float) -> tuple[Float64[np.ndarray, " 3"], Float64[np.ndarray, " 3"]]:
        """Corners of the cloud's box, with so much about it."""
        return self.lower - margin, self.upper + margin

    def told(self, places: Places) -> Float64[np.ndarray, " m"]:
        """f, as near to zero as the nearest point of the cloud; NaN where nothing is said."""
        blocks = [self.block(places[start : start + BLOCK]) for start in range(0, len(places), BLOCK)]
        return np.concatenate([np.empty(0), *blocks])

    def block(self, places: Places) -> Float64[np.ndarray, " m"]:
        """The same of a few."""
        found = np.full(len(places), np.nan)
        gap, nearest = map(np.asarray, self.rim.query(places, workers=-1))
        close = NEAREST * np.asarray(self.tree.query(places, workers=-1)[0])
        own = np.flatnonzero(gap < np.minimum(close, self.spans[nearest]))
        at, gap, rows = places[own], gap[own], np.arange(len(own))
        outside = np.maximum(at - self.upper, self.lower - at).max(axis=1)
        heights = at @ self.normals.T - np.einsum("rd,rd->r", self.rim.data, self.normals)
        alone = np.maximum(heights[rows, nearest[own]], outside)
        asked = cdist(at, self.rim.data) <= AROUND * gap[:, None]
        together = np.maximum(self.combined(heights, asked), outside)
        agreed = alone * together > 0.0
        found[own[agreed]] = np.clip(together, -gap, gap)[agreed]
        return found

    def combined(
        self, heights: Float64[np.ndarray, "m r"], asked: Bool[np.ndarray, "m r"]
    ) -> Float64[np.ndarray, " m"]:
        """max over i of min over j of those that are asked, j = i or concave with i."""
        near = np.where(asked, heights, np.inf)
        found = np.full(len(near), -np.inf)
        for i, pairs in enumerate(self.concave):
            joined = np.minimum(near[:, i], near[:, pairs].min(axis=1, initial=np.inf))
            found = np.where(asked[:, i], np.maximum(found, joined), found)
        return found

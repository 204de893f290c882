"""Whether a mesh and the points that it was made of speak of the same surface, without a ground truth.

Surface is guessed where its confidence is zero (`weingarten.metrics.confidence`, whose symbols these are). A
point is missed when the mesh is farther from it than MISSED r, beside what noise allows. Missed points that
are neighbours are a patch: single ones are outliers or a rounded edge, many in one place a lost detail.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from weingarten.mesh import Mesh
from weingarten.metrics.confidence import EIGHTH, NOISE, confidence, spacing
from weingarten.scan.sampling import sample_surface

Points = Float64[np.ndarray, "n 3"]

MISSED = 0.5
"""Distance in r beyond which the mesh misses a point."""

SAMPLES = 20_000
"""On the mesh; a share of 1 % is told to within 0.07 %."""

SHARE_GUESSED, SHARE_MISSED, PATCH = 0.005, 0.01, 10
"""Shares, and points of one patch, from which on a person should look. A small hole that was closed leaves
a dozen points on its wall."""


@dataclass(frozen=True)
class Coverage:
    """guessed: share of the mesh's area that is far from all points.
    missed: share of the points that are far from the mesh. patch: the most of them that lie in one place.
    """

    guessed: float
    missed: float
    patch: Float64[np.ndarray, "m 3"]

    @property
    def doubts(self) -> tuple[str, ...]:
        """What a person should know, a sentence each; none where nothing speaks against the mesh."""
        found: tuple[str, ...] = ()
        if self.guessed > SHARE_GUESSED:
            found += (
                f"{100 * self.guessed:.1f} % of the surface is far from all points: what was not scanned "
                "there is a guess.",
            )
        if self.missed > SHARE_MISSED:
            found += (
                f"{100 * self.missed:.1f} % of the points are off the mesh by more than half the distance "
                "between them: it misses detail there, or they are outliers.",
            )
        elif len(self.patch) >= PATCH:
            place = ", ".join(f"{value:.4g}" for value in self.patch.mean(axis=0))
            found += (
                f"{len(self.patch)} points in one place, around ({place}), are off the mesh: it misses a "
                "small hole or rib there.",
            )
        return found


def coverage(
    mesh: Mesh, points: Points, off: Float64[np.ndarray, " n"], noise: float, seed: int = 0
) -> Coverage:
    """Of a mesh and points in one frame.

    off: the points' distances from the mesh. noise: mean distance of the points from their surface, in the
    same unit. seed: of the samples on the mesh. Raises InputError when no face has an area.
    """
    apart = spacing(KDTree(points), points)
    missed = off > MISSED * apart + NOISE * noise
    places = sample_surface(mesh, SAMPLES, seed)[0]
    return Coverage(
        guessed=float(np.mean(confidence(places, points, noise) == 0.0)),
        missed=float(np.mean(missed)),
        patch=largest_patch(points[missed], np.minimum(apart, np.median(apart))[missed]),
    )


def largest_patch(points: Points, reach: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, "m 3"]:
    """Of some points the largest group of neighbours: one within the other's reach, of its EIGHTH nearest."""
    if len(points) < PATCH:
        return points[:0]
    found = KDTree(points).query(points, k=min(EIGHTH + 1, len(points)), workers=-1)
    gaps, near = map(np.asarray, found)
    own, other = np.nonzero(gaps <= reach[:, None])
    graph = coo_array((np.ones(len(own)), (own, near[own, other])), shape=(len(points), len(points)))
    label = connected_components(graph, directed=False)[1]
    return points[label == np.bincount(label).argmax()]

"""Whether a mesh and the points that it was made of speak of the same surface, without a ground truth.

Surface is guessed where its confidence is zero (`weingarten.metrics.confidence`, whose symbols these are). A
point is missed when the mesh is farther from it than MISSED r, beside what noise allows.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from weingarten.mesh import Mesh
from weingarten.metrics.confidence import NOISE, confidence, spacing
from weingarten.scan.sampling import sample_surface

Points = Float64[np.ndarray, "n 3"]

MISSED = 0.5
"""Distance in r beyond which the mesh misses a point."""

SAMPLES = 20_000
"""On the mesh; a share of 1 % is told to within 0.07 %."""

SHARE_GUESSED, SHARE_MISSED = 0.005, 0.01
"""Shares above which a person should look."""


@dataclass(frozen=True)
class Coverage:
    """guessed: share of the mesh's area that is far from all points.
    missed: share of the points that are far from the mesh.
    """

    guessed: float
    missed: float

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
        return found


def coverage(
    mesh: Mesh, points: Points, off: Float64[np.ndarray, " n"], noise: float, seed: int = 0
) -> Coverage:
    """Of a mesh and points in one frame.

    off: the points' distances from the mesh. noise: mean distance of the points from their surface, in the
    same unit. seed: of the samples on the mesh. Raises InputError when no face has an area.
    """
    allowed = MISSED * spacing(KDTree(points), points) + NOISE * noise
    places = sample_surface(mesh, SAMPLES, seed)[0]
    return Coverage(
        guessed=float(np.mean(confidence(places, points, noise) == 0.0)),
        missed=float(np.mean(off > allowed)),
    )

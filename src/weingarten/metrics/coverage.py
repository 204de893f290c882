"""Whether a mesh and the points that it was made of speak of the same surface, without a ground truth.

Both figures compare a distance with r(p), that from a point p of the cloud to its EIGHTH neighbour. Of points
spread at random with density ρ on a surface, πρr² is about 8, and a place of the surface that is farther than
c r from all of them has probability exp(−8c²): 1e-14 at c = 2. So what is farther was not scanned.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64
from scipy.spatial import KDTree

from weingarten.mesh import Mesh
from weingarten.scan.sampling import sample_surface

Points = Float64[np.ndarray, "n 3"]

EIGHTH = 8
GUESSED, MISSED = 2.0, 0.5
"""Distances in r beyond which surface is a guess, and beyond which the mesh misses a point."""

NOISE = 4.0
"""How many times the noise of the cloud, its mean distance from planes, is allowed beside that."""

SAMPLES = 20_000
"""On the mesh; a share of 1 % is told to within 0.07 %."""

SHARE_GUESSED, SHARE_MISSED = 0.005, 0.01
"""Shares above which a person should look."""


@dataclass(frozen=True)
class Neighbourhood:
    """What lies near the points of a cloud. spacing: r of every point. noise: as in `coverage`."""

    tree: KDTree
    spacing: Float64[np.ndarray, " n"]
    noise: float

    @classmethod
    def of(cls, points: Points, noise: float) -> "Neighbourhood":
        """That of all the points."""
        tree = KDTree(points)
        return cls(tree, np.asarray(tree.query(points, k=EIGHTH + 1, workers=-1)[0])[:, -1], noise)

    def far(self, places: Float64[np.ndarray, "m 3"]) -> Bool[np.ndarray, " m"]:
        """Which places are so far from all points that surface there is a guess."""
        gap, nearest = self.tree.query(places, workers=-1)
        return gap > GUESSED * self.spacing[nearest] + NOISE * self.noise


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
    near = Neighbourhood.of(points, noise)
    return Coverage(
        guessed=float(np.mean(near.far(sample_surface(mesh, SAMPLES, seed)[0]))),
        missed=float(np.mean(off > MISSED * near.spacing + NOISE * noise)),
    )

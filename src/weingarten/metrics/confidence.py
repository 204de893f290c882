"""How far the points of a cloud bear out a place of a surface, without a ground truth.

With p the point nearest to a place, at a distance d, r(p) that from p to its EIGHTH neighbour, and the noise
of the cloud ν, its mean distance from planes:

    confidence = 2 − (d − NOISE ν) / r(p),   within [0, 1].

Of points spread at random with density ρ on a surface, πρr² is about 8, and a place of the surface that is
farther than c r from all of them has probability exp(−8c²): 3e-4 at c = 1, 1e-14 at c = 2. So at 1 there is
nothing to be said against a place, and at 0 it was not scanned: what the surface does there is a guess.
"""

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

Points = Float64[np.ndarray, "_ 3"]

EIGHTH = 8
NOISE = 4.0
"""How many times the noise is allowed beside the distance between points."""


def spacing(tree: KDTree, points: Points) -> Float64[np.ndarray, " _"]:
    """The distance from every point to its eighth neighbour; tree: of the points."""
    return np.asarray(tree.query(points, k=EIGHTH + 1, workers=-1)[0])[:, -1]


def confidence(places: Points, points: Points, noise: float) -> Float64[np.ndarray, " _"]:
    """Of places on a surface, from 0 to 1; all in one frame, noise in the same unit."""
    tree = KDTree(points)
    apart = spacing(tree, points)
    gap, nearest = tree.query(places, workers=-1)
    allowed = np.maximum(apart[nearest], np.finfo(np.float64).tiny)
    return np.clip(2.0 - (gap - NOISE * noise) / allowed, 0.0, 1.0)

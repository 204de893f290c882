"""Points moved towards their surface: what noise has scattered is brought together where the surface is flat.

With the plane of least squares through a point's neighbours, of variances v₁ ≤ v₂ ≤ v₃, and the noise's
standard deviation σ, the point goes to the plane by the share

    t = 1 / (1 + (e / FLAT)²),   e = max(0, v₁ − σ²) / v₂,

so nearly all of the way where all that is not flat is noise, and hardly at all near edges. Every round but
the first has to do with HALF of the noise that the round before had.
"""

import functools
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Float64, Int64
from scipy.spatial import KDTree
from torch import Tensor

from weingarten.scan.noise import Noise
from weingarten.scan.normals import least_planes
from weingarten.scan.open_boundary import rims

Points = Float64[np.ndarray, "n 3"]

FLAT = 0.03
"""Ratio of a neighbourhood's two smaller variances at which it counts half as flat: edges."""

ROUNDS, HALF = 2, 0.5
BLOCK = 20_000

FULL_WEIGHT = 1.5e-3
"""Uncertainty of a point, unit lengths, up to which it counts fully."""


@dataclass(frozen=True)
class Settled:
    """Points that a fit draws from, unit frame. noise: that they had.

    flat: t of each, normals: of unit length and arbitrary sign; None where there is no noise, and the points
    are as they were given.
    """

    points: Points
    noise: Noise
    flat: Float64[np.ndarray, " n"] | None = None
    normals: Points | None = None

    @property
    def weight(self) -> Float[Tensor, " n"] | None:
        """Of each point in the data term: min(1, FULL_WEIGHT / its uncertainty); None without noise.

        The uncertainty is that of a point gone to a plane through k others, of which twice is taken.
        """
        if self.flat is None:
            return None
        weight = np.minimum(1.0, FULL_WEIGHT / self.left(self.flat, 2.0))
        return torch.from_numpy(weight.astype(np.float32))

    @property
    def misfit(self) -> float | None:
        """Mean of the data term, weight · |f|, for the exact distance f; None without noise.

        Of Gaussian noise of standard deviation s the mean of |f| is s √(2/π).
        """
        weight = self.weight
        if self.flat is None or weight is None:
            return None
        return float((weight.numpy() * self.left(self.flat, 1.0)).mean() * np.sqrt(2.0 / np.pi))

    def left(self, flat: Float64[np.ndarray, " n"], sure: float) -> Float64[np.ndarray, " n"]:
        """What is left of the noise: σ √((1 − t)² + (sure t)² / k)."""
        return self.noise.level * np.sqrt((1.0 - flat) ** 2 + (sure * flat) ** 2 / self.noise.neighbours)

    @functools.cached_property
    def rims(self) -> tuple[Int64[np.ndarray, " _"], ...]:
        """Numbers of the points where the cloud ends, see `weingarten.scan.open_boundary.rims`."""
        return rims(self.points)


def settled(points: Points, noise: Noise) -> Settled:
    """After ROUNDS rounds; the same points where there is no noise."""
    if noise.level == 0.0:
        return Settled(points, noise)
    level = noise.level
    for _ in range(ROUNDS):
        flat, normals, offsets = flattened(points, noise.neighbours, level)
        points = points - (flat * offsets)[:, None] * normals
        level = HALF * noise.level
    flat, normals, _ = flattened(points, noise.neighbours, level)
    return Settled(points, noise, flat, normals)


def flattened(
    points: Points, neighbours: int, level: float
) -> tuple[Float64[np.ndarray, " n"], Points, Float64[np.ndarray, " n"]]:
    """t, the normal of the plane, and how far before it a point lies."""
    tree = KDTree(points)
    flat, normals, offsets = np.empty(len(points)), np.empty_like(points), np.empty(len(points))
    for start in range(0, len(points), BLOCK):
        block = slice(start, start + BLOCK)
        planes = least_planes(points[tree.query(points[block], k=neighbours + 1, workers=-1)[1]])
        excess = np.maximum(planes.variances[:, 0] - level**2, 0.0)
        ratio = excess / np.maximum(planes.variances[:, 1], np.finfo(float).tiny)
        flat[block] = 1.0 / (1.0 + (ratio / FLAT) ** 2)
        normals[block] = planes.normals
        offsets[block] = np.einsum("nd,nd->n", points[block] - planes.centres, planes.normals)
    return flat, normals, offsets

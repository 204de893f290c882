"""The points of every step: fresh draws on, off and near the surface, from one seeded generator."""

from typing import Protocol

import numpy as np
import torch
from jaxtyping import Float, Float64
from scipy.spatial import cKDTree
from torch import Tensor

from weingarten.scan.free_space import FreeSpace
from weingarten.scan.sample import NEAR, OFF_SURFACE, SURFACE, Sample

REACH = 1.1
"""Half side of the off-surface box, unit lengths (method §1)."""

NEIGHBOURS = 50
"""σ of a near-surface draw is the distance to this neighbour (method §1)."""

POOL = 200_000
"""Off-surface points whose signed distance is worked out once, before the first step."""


class Draws(Protocol):
    """Anything that yields the samples of a step, by domain."""

    def __call__(self, count: int, generator: torch.Generator) -> dict[str, Sample]: ...


class CloudDraws:
    """Draws from a cloud: `count` points of each domain (method §1).

    surface: from the cloud, with replacement between steps, without within a step if the cloud allows.
    off-surface: uniform in the box. near-surface: the surface draw plus N(0, σ²), σ per point.
    """

    def __init__(self, points: Float64[np.ndarray, "n 3"], tree: cKDTree) -> None:
        self.points = torch.from_numpy(points.astype(np.float32))
        self.sigma = torch.from_numpy(neighbour_distance(tree, points, NEIGHBOURS).astype(np.float32))

    def __call__(self, count: int, generator: torch.Generator) -> dict[str, Sample]:
        """The samples of one step, on the CPU."""
        total = len(self.points)
        if count <= total:
            chosen = torch.randperm(total, generator=generator)[:count]
        else:
            chosen = torch.randint(total, (count,), generator=generator)
        surface = self.points[chosen]
        noise = torch.randn(count, 3, generator=generator) * self.sigma[chosen].unsqueeze(-1)
        return {
            SURFACE: Sample(surface),
            OFF_SURFACE: self.off_surface(count, generator),
            NEAR: Sample(surface + noise),
        }

    def off_surface(self, count: int, generator: torch.Generator) -> Sample:
        """Uniform in the box, nothing known."""
        return Sample(uniform_in_box(count, generator))


class SignedDraws(CloudDraws):
    """Draws whose off-surface points know their signed distance where free space tells it."""

    def __init__(
        self,
        points: Float64[np.ndarray, "n 3"],
        tree: cKDTree,
        space: FreeSpace,
        generator: torch.Generator,
    ) -> None:
        super().__init__(points, tree)
        pool = uniform_in_box(POOL, generator)
        positions = pool.numpy().astype(np.float64)
        signs = space.signs(positions)
        distance = np.full(POOL, np.nan, dtype=np.float32)
        known = signs != 0
        distance[known] = signs[known] * tree.query(positions[known], workers=-1)[0]
        self.pool = Sample(pool, torch.from_numpy(distance))

    def off_surface(self, count: int, generator: torch.Generator) -> Sample:
        """Uniform in the box, with signed distance or NaN."""
        chosen = torch.randint(len(self.pool), (count,), generator=generator)
        assert self.pool.distance is not None
        return Sample(self.pool.points[chosen], self.pool.distance[chosen])


def uniform_in_box(count: int, generator: torch.Generator) -> Float[Tensor, "n 3"]:
    """Uniform in [−REACH, REACH]³."""
    return (2.0 * torch.rand(count, 3, generator=generator) - 1.0) * REACH


def neighbour_distance(
    tree: cKDTree, points: Float64[np.ndarray, "n 3"], neighbour: int, block: int = 200_000
) -> Float64[np.ndarray, " n"]:
    """Distance of each point to its k-th other neighbour (the last one there is, in a smaller cloud)."""
    k = min(neighbour, len(points) - 1) + 1
    blocks = [
        tree.query(points[start : start + block], k=[k], workers=-1)[0][:, 0]
        for start in range(0, len(points), block)
    ]
    return np.concatenate(blocks)

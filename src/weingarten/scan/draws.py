"""The points of every step: fresh draws on, off and near the surface, from one seeded generator.

Everything lives where the generator does: on a GPU nothing of a step comes from the CPU.
"""

from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Float, Float64, Int64
from scipy.spatial import KDTree
from torch import Tensor

from weingarten.scan.free_space import FreeSpace
from weingarten.scan.sample import NEAR, OFF_SURFACE, SURFACE, Sample

REACH = 1.1
"""Half side of the off-surface box, unit lengths."""

NEIGHBOURS = 50
"""σ of a near-surface draw is the distance to this neighbour."""

POOL = 120_000
"""Off-surface points whose signed distance is worked out once, before the first step."""

FAR, SPREAD = 0.3, 0.06
"""Share of them that is uniform in the box; how far about the cloud the others lie, unit lengths."""


@runtime_checkable
class Draws(Protocol):
    """Anything that yields the samples of a step, by domain: `count` points of each, with angles.

    generator: torch's, or `weingarten.scan.generators.Generators` where many parts are drawn together.
    """

    def __call__(self, count: int, generator: Any) -> dict[str, Sample]: ...


class CloudDraws:
    """Draws from a cloud: `count` points of each domain.

    surface: from the cloud, with replacement between steps, spread over it within a step (`spread`).
    off-surface: uniform in the box. near-surface: the surface draw plus N(0, σ²), σ per point.
    detail: by what factor a field's waves should begin shorter, as far as is known of the part.
    pace: by what factor the rate should be smaller.
    apart: distance of the closest sheets of the surface; the side of the box where none are known.
    weight: what each point of the cloud counts; None where all count fully.
    known: share of the points at which the direction of the surface is known; 1 where nobody asked for it.
    """

    detail: float = 1.0
    pace: float = 1.0
    apart: float = 2.0 * REACH
    known: float = 1.0
    weight: Float[Tensor, " n"] | None = None

    def __init__(self, points: Float64[np.ndarray, "n 3"], tree: KDTree) -> None:
        self.points = torch.from_numpy(points.astype(np.float32))
        self.sigma = torch.from_numpy(neighbour_distance(tree, points, NEIGHBOURS).astype(np.float32))

    def move(self, device: torch.device) -> None:
        """Go to the device of the generator that will be drawn with."""
        self.points, self.sigma = self.points.to(device), self.sigma.to(device)
        self.weight = None if self.weight is None else self.weight.to(device)

    def __call__(self, count: int, generator: torch.Generator) -> dict[str, Sample]:
        """The samples of one step, on the device of the generator."""
        chosen = spread(count, len(self.points), generator)
        surface = self.surface(chosen)
        near = self.near(surface.points, chosen, generator)
        samples = {
            SURFACE: surface,
            OFF_SURFACE: self.off_surface(count, generator),
            NEAR: near,
        }
        return {name: replace(sample, angles=angles(count, generator)) for name, sample in samples.items()}

    def surface(self, chosen: Tensor) -> Sample:
        """The points of these numbers."""
        return Sample(self.points[chosen], weight=self.weights(chosen))

    def weights(self, chosen: Tensor) -> Float[Tensor, " n"] | None:
        """Of these points, where not all count fully."""
        return None if self.weight is None else self.weight[chosen]

    def near(self, surface: Float[Tensor, "n 3"], chosen: Tensor, generator: torch.Generator) -> Sample:
        """About the surface draw, which are the points number `chosen`."""
        noise = torch.randn(len(surface), 3, generator=generator, device=generator.device)
        return Sample(surface + noise * self.sigma[chosen].unsqueeze(-1))

    def off_surface(self, count: int, generator: torch.Generator) -> Sample:
        """Uniform in the box, nothing known."""
        return Sample(uniform_in_box(count, generator))


class SignedDraws(CloudDraws):
    """Draws whose off-surface points know their signed distance where free space tells it.

    Uniform draws seldom fall into thin walls and narrow gaps, and there the sign matters most: so FAR of the
    points are uniform in the box, the others lie about the cloud, at N(0, SPREAD²), where signs are known.

    nearest: to each point of the pool whose distance is known, the number of the cloud's nearest; else −1.
    """

    def __init__(
        self,
        points: Float64[np.ndarray, "n 3"],
        tree: KDTree,
        space: FreeSpace,
        generator: torch.Generator,
    ) -> None:
        super().__init__(points, tree)
        far = uniform_in_box(int(FAR * POOL), generator)
        about = torch.randint(len(self.points), (2 * POOL,), generator=generator)
        close = self.points[about] + SPREAD * torch.randn(len(about), 3, generator=generator)
        labelled = torch.from_numpy(space.signs(positions(close)) != 0)
        close = close[labelled & (close.abs().amax(dim=1) < REACH)]
        self.pool = torch.cat([far, close[: POOL - len(far)]])
        distance, self.nearest = space.told(positions(self.pool))
        self.distance = torch.from_numpy(distance)

    def move(self, device: torch.device) -> None:
        """See CloudDraws."""
        super().move(device)
        self.pool, self.distance = self.pool.to(device), self.distance.to(device)

    def off_surface(self, count: int, generator: torch.Generator) -> Sample:
        """Points of the pool, with signed distance or NaN."""
        chosen = torch.randint(len(self.pool), (count,), generator=generator, device=generator.device)
        return Sample(self.pool[chosen], self.distance[chosen])


class MeasuredDraws(CloudDraws):
    """Draws whose points off and near the surface know their distance to the nearest point of the cloud.

    Both come from pools of POOL points, whose distances are worked out once: no step has to ask the tree.
    """

    def __init__(self, points: Float64[np.ndarray, "n 3"], tree: KDTree, generator: torch.Generator) -> None:
        super().__init__(points, tree)
        about = spread(POOL, len(self.points), generator)
        noise = torch.randn(POOL, 3, generator=generator)
        self.pools = {
            OFF_SURFACE: uniform_in_box(POOL, generator),
            NEAR: self.points[about] + noise * self.sigma[about].unsqueeze(-1),
        }
        self.distances = {
            name: torch.from_numpy(tree.query(positions(pool), workers=-1)[0].astype(np.float32))
            for name, pool in self.pools.items()
        }

    def move(self, device: torch.device) -> None:
        """See CloudDraws."""
        super().move(device)
        self.pools = {name: pool.to(device) for name, pool in self.pools.items()}
        self.distances = {name: distance.to(device) for name, distance in self.distances.items()}

    def off_surface(self, count: int, generator: torch.Generator) -> Sample:
        """Points of the pool that is uniform in the box."""
        return self.of_pool(OFF_SURFACE, count, generator)

    def near(self, surface: Float[Tensor, "n 3"], chosen: Tensor, generator: torch.Generator) -> Sample:
        """Points of the pool about the cloud."""
        return self.of_pool(NEAR, len(surface), generator)

    def of_pool(self, name: str, count: int, generator: torch.Generator) -> Sample:
        """So many of it, with replacement."""
        chosen = torch.randint(POOL, (count,), generator=generator, device=generator.device)
        return Sample(self.pools[name][chosen], unsigned=self.distances[name][chosen])


def spread(count: int, total: int, generator: torch.Generator) -> Int64[Tensor, " count"]:
    """So many of range(total), one from each of `count` equal stretches of it, in random order.

    None twice where there are enough, but for neighbours at the ends of two stretches; the time depends on
    `count` alone.
    """
    device = generator.device
    within = torch.rand(count, generator=generator, device=device, dtype=torch.float64)
    order = torch.randperm(count, generator=generator, device=device)
    return ((order + within) * (total / count)).long().clamp_(max=total - 1)


def positions(points: Float[Tensor, "n 3"]) -> Float64[np.ndarray, "n 3"]:
    """The same points for scipy."""
    return points.numpy().astype(np.float64)


def uniform_in_box(count: int, generator: torch.Generator) -> Float[Tensor, "n 3"]:
    """Uniform in [−REACH, REACH]³."""
    return (2.0 * torch.rand(count, 3, generator=generator, device=generator.device) - 1.0) * REACH


def angles(count: int, generator: torch.Generator) -> Float[Tensor, " n"]:
    """Uniform in [0, 2π)."""
    return 2.0 * torch.pi * torch.rand(count, generator=generator, device=generator.device)


def neighbour_distance(
    tree: KDTree, points: Float64[np.ndarray, "n 3"], neighbour: int, block: int = 200_000
) -> Float64[np.ndarray, " n"]:
    """Distance of each point of a tree to its k-th other neighbour (in a smaller cloud, the last there is).

    Asked for in the tree's own order: what is near in space is then near in memory, which halves the time.
    """
    k = min(neighbour, len(points) - 1) + 1
    distance = np.empty(len(points))
    for start in range(0, len(points), block):
        rows = tree.indices[start : start + block]
        distance[rows] = tree.query(points[rows], k=k, workers=-1)[0][:, -1]
    return distance

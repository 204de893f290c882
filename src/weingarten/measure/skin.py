"""The points of a cloud, what the field says of the surface at them, and which of them are side by side."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.spatial import KDTree

from weingarten.frame import Frame
from weingarten.measure.patch import Patch
from weingarten.measure.surface import Points, Values, directions
from weingarten.scan.noise import noise_of

NEIGHBOURS = 12
TURN = np.cos(np.radians(60.0))
"""Neighbours whose normals differ by more are on another wall, or on the other side of a sharp edge."""

FAR = 4.0
"""Times the median distance to the farthest neighbour: beyond, points are no neighbours."""

ALONE = 0.5
"""Points that lack so large a share of their neighbours are no place to begin at."""

RIPPLE, SLOPE = 6e-4, 0.1
"""How far a field's surface is from the true one, r.m.s., unit lengths; and the least ‖∇f‖ believed."""

Indices = Int64[np.ndarray, " m"]
Mask = Bool[np.ndarray, " n"]


@runtime_checkable
class Sampled(Protocol):
    """A field at n world points, as `weingarten.world_field.FieldSample`."""

    @property
    def distance(self) -> Values:
        """Signed, negative inside, world units."""
        ...

    @property
    def gradient(self) -> Points:
        """No unit, outward."""
        ...

    @property
    def curvatures(self) -> Float64[np.ndarray, "n 2"]:
        """κ₁ ≤ κ₂, one over world unit."""
        ...


WorldFunction = Callable[[Points], Sampled]


@dataclass(frozen=True, eq=False)
class Skin:
    """In the unit frame.

    points: of the cloud. places: the same, moved by −t f/‖∇f‖ along the normal, with t = σ²/(σ² + RIPPLE²),
    σ the noise: to the field's surface where that is the more certain. curvatures: medians over neighbours.
    neighbours: of every point, the point itself in place of those it has not. noise: σ. spacing: median
    distance from a point to the next. rough: by how much curvature changes from a point to its neighbours,
    times the spacing: the least where a surface is well within one primitive.
    """

    points: Points
    places: Points
    normals: Points
    curvatures: Float64[np.ndarray, "n 2"]
    neighbours: Int64[np.ndarray, "n k"]
    noise: float
    spacing: float
    rough: Values

    @classmethod
    def of(cls, points: Points, field: WorldFunction, frame: Frame) -> "Skin":
        """Of points in world units."""
        sample = field(points)
        gradient = np.asarray(sample.gradient, dtype=np.float64)
        normals = directions(gradient)
        curvatures = np.asarray(sample.curvatures, dtype=np.float64) * frame.scale
        unit = frame.to_unit(points)
        count = min(NEIGHBOURS + 1, len(points))
        tree = KDTree(unit)
        noise = noise_of(unit, tree).level
        away = np.asarray(sample.distance, dtype=np.float64) / frame.scale
        away = (away / np.maximum(np.linalg.norm(gradient, axis=1), SLOPE)).clip(-4.0 * noise, 4.0 * noise)
        places = unit - (noise**2 / (noise**2 + RIPPLE**2) * away)[:, None] * normals
        distance, near = tree.query(unit, k=count, workers=-1)
        spacing = float(np.median(distance[:, 1]))
        alike = np.einsum("nd,nkd->nk", normals, normals[near]) > TURN
        close = distance <= FAR * np.median(distance[:, -1])
        near = np.where(alike & close, near, np.arange(len(points))[:, None])
        change = np.abs(curvatures[near] - curvatures[:, None]).sum(axis=2).mean(axis=1)
        curvatures = np.median(curvatures[near], axis=1)
        rough = spacing * np.maximum(change, np.median(change[near], axis=1))
        rough[(near == np.arange(len(points))[:, None]).mean(axis=1) > ALONE] = np.inf
        return cls(unit, places, normals, curvatures, near.astype(np.int64), noise, spacing, rough)

    def patch(self, chosen: Indices) -> Patch:
        """Some of its points, where they are the most certain."""
        return Patch(self.places[chosen], self.normals[chosen], self.curvatures[chosen])

    def connected(self, allowed: Mask, start: Indices, most: int | None = None) -> Int64[np.ndarray, " r"]:
        """The allowed points that are reached from some over neighbours, about `most` if given."""
        reached, front, count = np.zeros(len(allowed), dtype=bool), start[allowed[start]], 0
        while len(front):
            reached[front] = True
            count += len(front)
            if most is not None and count >= most:
                break
            near = np.zeros(len(allowed), dtype=bool)
            near[self.neighbours[front]] = True
            front = np.flatnonzero(near & allowed & ~reached)
        return np.flatnonzero(reached)

    def beside(self, chosen: Mask, steps: int) -> Mask:
        """Some points and those within so many steps of them."""
        for _ in range(steps):
            more = chosen.copy()
            more[self.neighbours[chosen]] = True
            chosen = more | chosen[self.neighbours].any(axis=1)
        return chosen

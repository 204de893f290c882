"""What a scan lacks: where points of a surface are missing, or fewer than elsewhere.

Every flaw is a probability of being scanned, p(x) ∈ [0, 1]; a flawed scan keeps the points of a uniform
sample with the product of them. What a scanner adds, noise and outliers, is in `weingarten.scan.sampling`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from igl.embree import EmbreeIntersector
from jaxtyping import Float64

from weingarten.errors import InputError, OptionError
from weingarten.mesh import Mesh
from weingarten.scan.sampling import Seed, generator

Points = Float64[np.ndarray, "n 3"]
Draw = Callable[[int, Seed], Points]
Flaw = Callable[[Points], Float64[np.ndarray, " n"]]

PROBE = 20_000
"""Points of a surface by which flaws are laid out."""

MOST_ROUNDS = 200
DISTANCE, LIFT = 1.5, 1e-4
"""Of viewpoints from the middle of the box, and of a ray's end from its surface, in diagonals of the box."""


@dataclass(frozen=True)
class Uneven:
    """p = ratio^−t, where t goes from 0 to 1 along `direction` over the part."""

    ratio: float
    direction: Float64[np.ndarray, " 3"]
    first: float
    last: float

    def __call__(self, points: Points) -> Float64[np.ndarray, " n"]:
        """p of every point."""
        along = (points @ self.direction - self.first) / (self.last - self.first)
        return self.ratio ** -np.clip(along, 0.0, 1.0)


@dataclass(frozen=True)
class Missing:
    """p = 0 within a ball, 1 elsewhere."""

    centre: Float64[np.ndarray, " 3"]
    radius: float

    def __call__(self, points: Points) -> Float64[np.ndarray, " n"]:
        """p of every point."""
        return (np.linalg.norm(points - self.centre, axis=1) > self.radius).astype(np.float64)


class Visible:
    """p = max over viewpoints that see a point of |cos θ|, θ between its normal and the way to the viewpoint.

    A scanner's rays, evenly spread over what it sees, meet a surface as often as that. Points are seen where
    nothing of the mesh is between; concealed ones are not scanned at all.
    """

    def __init__(self, mesh: Mesh, viewpoints: Float64[np.ndarray, "v 3"]) -> None:
        lowest, highest = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        self.centre, self.size = (lowest + highest) / 2, float(np.linalg.norm(highest - lowest))
        self.viewpoints = self.scaled(viewpoints)
        self.rays = EmbreeIntersector()
        vertices = np.asfortranarray(self.scaled(mesh.vertices), dtype=np.float32)
        self.rays.init(vertices, np.asfortranarray(mesh.faces, dtype=np.int32))
        self.corners = self.scaled(mesh.corners.reshape(-1, 3)).reshape(-1, 3, 3)

    def scaled(self, points: Points) -> Points:
        """Into the frame of the rays, which are single precision."""
        return (points - self.centre) / self.size

    def __call__(self, points: Points) -> Float64[np.ndarray, " n"]:
        """p of every point."""
        scaled = self.scaled(points)
        chance = np.zeros(len(points))
        for viewpoint in self.viewpoints:
            way = scaled - viewpoint
            length = np.linalg.norm(way, axis=1)
            way /= length[:, None]
            chance = np.maximum(chance, self.facing(viewpoint, way, length))
        return chance

    def facing(
        self, viewpoint: Float64[np.ndarray, " 3"], way: Points, length: Float64[np.ndarray, " n"]
    ) -> Float64[np.ndarray, " n"]:
        """|cos θ| of the points at the ends of these ways, 0 where something is before them."""
        origin = viewpoint.astype(np.float32)
        hits = [self.rays.intersectRay_first(origin, one) for one in way.astype(np.float32)]
        face = np.array([hit[0] for hit in hits], dtype=np.int64)
        first = np.array([hit[1] for hit in hits], dtype=np.float64)
        seen = (face >= 0) & (np.abs(first - length) < LIFT)
        a, b, c = self.corners[face[seen]].transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
        cosine = np.zeros(len(way))
        cosine[seen] = np.abs(np.einsum("nd,nd->n", normal, way[seen]))
        return cosine


def uneven(ratio: float, probe: Points, seed: Sequence[int]) -> Uneven:
    """`ratio` times as many points at one end of the part as at the other, along a direction by the seed.

    Raises OptionError for a ratio below 1.
    """
    if not (np.isfinite(ratio) and ratio >= 1.0):
        raise OptionError(f"The ratio of densities must be a number of 1 or more; got {ratio}.")
    direction = generator(seed).standard_normal(3)
    direction /= np.linalg.norm(direction)
    along = probe @ direction
    return Uneven(ratio, direction, float(along.min()), float(along.max()))


def missing(share: float, probe: Points, seed: Sequence[int]) -> Missing:
    """A ball about some point of the surface that holds this share of it. OptionError outside [0, 1)."""
    if not 0.0 <= share < 1.0:
        raise OptionError(f"The missing share must be at least 0 and less than 1; got {share}.")
    centre = probe[generator(seed).integers(len(probe))]
    return Missing(centre, float(np.quantile(np.linalg.norm(probe - centre, axis=1), share)))


def visible(mesh: Mesh, count: int, seed: Sequence[int]) -> Visible:
    """Seen from `count` viewpoints, evenly spread about the part, turned by the seed. OptionError below 1."""
    if count < 1:
        raise OptionError(f"A scanner needs at least one viewpoint; got {count}.")
    lowest, highest = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    turn, _ = np.linalg.qr(generator(seed).standard_normal((3, 3)))
    away = DISTANCE * np.linalg.norm(highest - lowest)
    return Visible(mesh, (lowest + highest) / 2 + away * evenly_spread(count) @ turn)


def evenly_spread(count: int) -> Points:
    """Directions, one on each of `count` bands of equal area of the sphere, a golden angle from the last."""
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    angle = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    flat = np.sqrt(1.0 - height**2)
    return np.column_stack([flat * np.cos(angle), flat * np.sin(angle), height])


def flawed(draw: Draw, count: int, flaws: Sequence[Flaw], seed: Sequence[int]) -> Points:
    """`count` points of a surface, each kept with the product of the flaws' probabilities.

    draw: so many points uniform by area, from a seed. InputError where next to nothing is left to scan.
    """
    kept: list[Points] = []
    found = 0
    for number in range(MOST_ROUNDS):
        points = draw(max(count, PROBE), (*seed, 2 * number))
        chance = np.ones(len(points))
        for flaw in flaws:
            chance *= flaw(points)
        kept.append(points[generator((*seed, 2 * number + 1)).random(len(points)) < chance])
        found += len(kept[-1])
        if found >= count:
            return np.concatenate(kept)[:count]
    raise InputError(f"Only {found} of {count} points were left to scan; ask for fewer flaws or points.")

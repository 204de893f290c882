"""Planes."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.measure.patch import Patch
from weingarten.measure.reach import beyond
from weingarten.measure.surface import Pairs, Points, Step, Values, Vector, across, directions, unit
from weingarten.scan.sampling import generator

TRIPLES, SHARE, STREAM = 100, 0.4, 11
"""Planes that are tried, and the share of the points that has to be near."""


def least_squares(points: Points) -> tuple[Vector, Vector]:
    """Position and normal of the plane of least squares."""
    mean = points.mean(axis=0)
    return mean, np.linalg.eigh((points - mean).T @ (points - mean))[1][:, 0]


def consensus(points: Points) -> tuple[Vector, Vector]:
    """Position and normal of the plane through three of the points to which SHARE of all are the nearest.

    Where other surfaces begin within the patch, that is the one which is not pulled aside by them.
    """
    chosen = generator((len(points), STREAM)).integers(0, len(points), (TRIPLES, 3))
    a, b, c = points[chosen].transpose(1, 0, 2)
    normals = directions(np.cross(b - a, c - a))
    distance = np.abs(np.einsum("td,tnd->tn", normals, points[None] - a[:, None]))
    width = np.quantile(distance, SHARE, axis=1)
    best = int(np.argmin(np.where(np.linalg.norm(normals, axis=1) > 0.5, width, np.inf)))
    return a[best], normals[best]


@dataclass(frozen=True, eq=False)
class Plane:
    """d = n·(x − position)."""

    position: Vector
    normal: Vector

    KIND: ClassVar[str] = "plane"
    FREEDOM: ClassVar[int] = 3

    @classmethod
    def guesses(cls, patch: Patch) -> "list[Plane]":
        """That of least squares, and that through three points which most others are the nearest to."""
        return [cls.facing(patch, *found) for found in (least_squares(patch.points), consensus(patch.points))]

    @classmethod
    def facing(cls, patch: Patch, position: Vector, normal: Vector) -> "Plane":
        """A plane whose normal points to where the patch's do."""
        return cls(position, normal if patch.normals.mean(axis=0) @ normal >= 0 else -normal)

    def distance(self, points: Points) -> Values:
        """The signed distance."""
        return (points - self.position) @ self.normal

    def normals(self, points: Points) -> Points:
        """The same everywhere."""
        return np.broadcast_to(self.normal, points.shape)

    def curvatures(self, points: Points) -> Pairs:
        """0, 0."""
        return np.zeros((len(points), 2))

    def slopes(self, points: Points) -> Float64[np.ndarray, "n p"]:
        """By the tilts, e·(x − position); by the shift, −1."""
        tilts = (points - self.position) @ np.stack(across(self.normal), axis=1)
        return np.column_stack([tilts, np.full(len(points), -1.0)])

    def moved(self, step: Step) -> "Plane":
        """Tilted by two angles, and shifted."""
        first, second = across(self.normal)
        normal = unit(self.normal + step[0] * first + step[1] * second)
        return Plane(self.position + step[2] * self.normal, normal)

    @property
    def turned(self) -> "Plane":
        """The same plane, its normal the other way."""
        return Plane(self.position, -self.normal)

    def centred(self, points: Points) -> "Plane":
        """Its position under the mean of the points."""
        mean = points.mean(axis=0)
        return Plane(mean - ((mean - self.position) @ self.normal) * self.normal, self.normal)

    def geometry(self) -> dict[str, Any]:
        """Its outward normal, and a position on it."""
        return {"position": self.position.tolist(), "normal": self.normal.tolist()}

    def extent(self, points: Points, area: float) -> dict[str, Any]:
        """The sides of the smallest rectangle around it."""
        # a third of a second to import
        from trimesh.bounds import oriented_bounds_2D

        flat = (points - self.position) @ np.stack(across(self.normal), axis=1)
        width, length = sorted(float(side) * beyond(len(flat)) for side in oriented_bounds_2D(flat)[1])
        return {"length": length, "width": width}

    def placed(self, frame: Frame) -> "Plane":
        """From the unit frame to the world."""
        return Plane(frame.to_world(self.position[None])[0], self.normal)

    def sensible(self, reach: float) -> bool:
        """Always."""
        return True

"""Planes."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from weingarten.frame import Frame
from weingarten.measure.patch import Patch
from weingarten.measure.reach import beyond
from weingarten.measure.surface import Pairs, Points, Step, Values, Vector, across, unit


@dataclass(frozen=True, eq=False)
class Plane:
    """d = n·(x − position)."""

    position: Vector
    normal: Vector

    KIND: ClassVar[str] = "plane"
    FREEDOM: ClassVar[int] = 3

    @classmethod
    def guesses(cls, patch: Patch) -> list[Self]:
        """That of least squares, its normal where the patch's point to."""
        mean = patch.points.mean(axis=0)
        normal = np.linalg.eigh((patch.points - mean).T @ (patch.points - mean))[1][:, 0]
        return [cls(mean, normal if patch.normals.mean(axis=0) @ normal >= 0 else -normal)]

    def distance(self, points: Points) -> Values:
        """The signed distance."""
        return (points - self.position) @ self.normal

    def normals(self, points: Points) -> Points:
        """The same everywhere."""
        return np.broadcast_to(self.normal, points.shape)

    def curvatures(self, points: Points) -> Pairs:
        """0, 0."""
        return np.zeros((len(points), 2))

    def moved(self, step: Step) -> Self:
        """Tilted by two angles, and shifted."""
        first, second = across(self.normal)
        normal = unit(self.normal + step[0] * first + step[1] * second)
        return type(self)(self.position + step[2] * self.normal, normal)

    @property
    def turned(self) -> Self:
        """The same plane, its normal the other way."""
        return type(self)(self.position, -self.normal)

    def centred(self, points: Points) -> Self:
        """Its position under the mean of the points."""
        mean = points.mean(axis=0)
        return type(self)(mean - ((mean - self.position) @ self.normal) * self.normal, self.normal)

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

    def placed(self, frame: Frame) -> Self:
        """From the unit frame to the world."""
        return type(self)(frame.to_world(self.position[None])[0], self.normal)

    def sensible(self, reach: float) -> bool:
        """Always."""
        return True

"""Spheres."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.measure.patch import Patch
from weingarten.measure.surface import Pairs, Points, Step, Values, Vector, ball, directions


@dataclass(frozen=True, eq=False)
class Sphere:
    """d = ‖x − position‖ − r."""

    position: Vector
    radius: float

    KIND: ClassVar[str] = "sphere"
    FREEDOM: ClassVar[int] = 4

    @classmethod
    def guesses(cls, patch: Patch) -> "list[Sphere]":
        """That on which the patch's normals stand."""
        centre, radius = ball(patch.points, patch.normals)
        return [cls(centre, abs(radius))]

    def distance(self, points: Points) -> Values:
        """The signed distance, positive outside."""
        return np.linalg.norm(points - self.position, axis=1) - self.radius

    def normals(self, points: Points) -> Points:
        """Away from the centre."""
        return directions(points - self.position)

    def curvatures(self, points: Points) -> Pairs:
        """1/r, 1/r."""
        return np.full((len(points), 2), 1.0 / self.radius)

    def slopes(self, points: Points) -> Float64[np.ndarray, "n p"]:
        """By the shifts, −n; by the radius, −1."""
        return np.column_stack([-self.normals(points), np.full(len(points), -1.0)])

    def moved(self, step: Step) -> "Sphere":
        """Shifted, and larger."""
        return Sphere(self.position + step[:3], self.radius + float(step[3]))

    def centred(self, points: Points) -> "Sphere":
        """As it is."""
        return self

    def geometry(self) -> dict[str, Any]:
        """Its radius and centre."""
        return {"radius": self.radius, "position": self.position.tolist()}

    def extent(self, points: Points, area: float) -> dict[str, Any]:
        """The share of the whole sphere that is there."""
        return {"coverage": min(1.0, area / (4.0 * np.pi * self.radius**2))}

    def placed(self, frame: Frame) -> "Sphere":
        """From the unit frame to the world."""
        return Sphere(frame.to_world(self.position[None])[0], self.radius * frame.scale)

    def sensible(self, reach: float) -> bool:
        """Whether it is not as good as flat."""
        return bool(0.0 < self.radius < 20.0 * reach)

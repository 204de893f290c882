"""Cylinders."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.measure.axis import Axis
from weingarten.measure.patch import Patch
from weingarten.measure.reach import spanned, swept
from weingarten.measure.surface import Pairs, Points, Step, Values, across, ball


@dataclass(frozen=True, eq=False)
class Cylinder:
    """d = ρ − r."""

    axis: Axis
    radius: float

    KIND: ClassVar[str] = "cylinder"
    FREEDOM: ClassVar[int] = 5

    @classmethod
    def guesses(cls, patch: Patch) -> "list[Cylinder]":
        """That whose axis is the most nearly at right angles to all normals."""
        direction = np.linalg.eigh(patch.normals.T @ patch.normals)[1][:, 0]
        basis, mean = np.stack(across(direction), axis=1), patch.points.mean(axis=0)
        centre, radius = ball((patch.points - mean) @ basis, patch.normals @ basis)
        return [cls(Axis(mean + basis @ centre, direction), abs(radius))]

    def distance(self, points: Points) -> Values:
        """The signed distance, positive outside."""
        return self.axis.distance(points) - self.radius

    def normals(self, points: Points) -> Points:
        """Away from the axis."""
        return self.axis.outward(points)

    def curvatures(self, points: Points) -> Pairs:
        """0, 1/r."""
        return np.tile([0.0, 1.0 / self.radius], (len(points), 1))

    def slopes(self, points: Points) -> Float64[np.ndarray, "n p"]:
        """By the axis' tilts and shifts; by the radius, −1."""
        moves = self.axis.slopes(points, self.normals(points))
        return np.column_stack([moves[:, :4], np.full(len(points), -1.0)])

    def moved(self, step: Step) -> "Cylinder":
        """Tilted by two angles, shifted by two lengths, and larger."""
        axis = self.axis.moved(step[:2], np.array([step[2], step[3], 0.0]))
        return Cylinder(axis, self.radius + float(step[4]))

    def centred(self, points: Points) -> "Cylinder":
        """Its position at the mean height of the points."""
        return Cylinder(self.axis.at(float(self.axis.height(points).mean())), self.radius)

    def geometry(self) -> dict[str, Any]:
        """Its radius, a position on its axis, and the axis."""
        axis = self.axis.upward
        return {"radius": self.radius, "position": axis.position.tolist(), "axis": axis.direction.tolist()}

    def extent(self, points: Points, area: float) -> dict[str, Any]:
        """Height along the axis, angle around it."""
        angle, full = swept(self.axis.angle(points))
        return {"height": spanned(self.axis.height(points)), "angle": angle, "full": full}

    def placed(self, frame: Frame) -> "Cylinder":
        """From the unit frame to the world."""
        return Cylinder(self.axis.placed(frame), self.radius * frame.scale)

    def sensible(self, reach: float) -> bool:
        """Whether it is not as good as flat."""
        return bool(0.0 < self.radius < 20.0 * reach)

"""Cones."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.measure.axis import Axis
from weingarten.measure.patch import Patch
from weingarten.measure.reach import spanned, swept
from weingarten.measure.surface import Pairs, Points, Step, Values, Vector


@dataclass(frozen=True, eq=False)
class Cone:
    """d = (ρ − r) cos α − z sin α: r is the radius at the axis' position; the axis points away from the apex.

    half_angle: α, between axis and surface, radians.
    """

    axis: Axis
    radius: float
    half_angle: float

    KIND: ClassVar[str] = "cone"
    FREEDOM: ClassVar[int] = 6

    @classmethod
    def guesses(cls, patch: Patch) -> "list[Cone]":
        """That to whose axis all normals are nearly at the same angle, and in whose apex planes meet."""
        turned = patch.normals - patch.normals.mean(axis=0)
        direction = np.linalg.eigh(turned.T @ turned)[1][:, 0]
        mean = patch.points.mean(axis=0)
        heights = np.einsum("nd,nd->n", patch.normals, patch.points - mean)
        apex = mean + np.linalg.lstsq(patch.normals, heights, rcond=1e-9)[0]
        along = float((mean - apex) @ direction)
        direction, along = (direction, along) if along > 0 else (-direction, -along)
        axis = Axis(apex + along * direction, direction)
        radius = float(np.median(axis.distance(patch.points)))
        if along <= 0.0 or radius <= 0.0:
            return []
        return [cls(axis, radius, math.atan2(radius, along))]

    @property
    def apex(self) -> Vector:
        """Where it has no radius."""
        return self.axis.position - self.radius / math.tan(self.half_angle) * self.axis.direction

    def distance(self, points: Points) -> Values:
        """The signed distance to the nearest line of it, positive outside."""
        rise = self.axis.height(points)
        return (self.axis.distance(points) - self.radius) * math.cos(self.half_angle) - rise * math.sin(
            self.half_angle
        )

    def normals(self, points: Points) -> Points:
        """Away from the axis, and back to the apex."""
        outward = self.axis.outward(points)
        return outward * math.cos(self.half_angle) - self.axis.direction * math.sin(self.half_angle)

    def curvatures(self, points: Points) -> Pairs:
        """0, cos α / ρ."""
        bent = math.cos(self.half_angle) / np.maximum(self.axis.distance(points), 1e-9)
        return np.column_stack([np.zeros(len(points)), bent])

    def slopes(self, points: Points) -> Float64[np.ndarray, "n p"]:
        """By the axis' tilts and shifts; by the radius, −cos α; by α, −(ρ − r) sin α − z cos α."""
        cos, sin = math.cos(self.half_angle), math.sin(self.half_angle)
        moves = self.axis.slopes(points, self.normals(points))
        wider = -(self.axis.distance(points) - self.radius) * sin - self.axis.height(points) * cos
        return np.column_stack([moves[:, :4], np.full(len(points), -cos), wider])

    def moved(self, step: Step) -> "Cone":
        """Tilted by two angles, shifted by two lengths, larger, and wider."""
        axis = self.axis.moved(step[:2], np.array([step[2], step[3], 0.0]))
        cone = Cone(axis, self.radius + float(step[4]), self.half_angle + float(step[5]))
        return cone if cone.half_angle >= 0.0 else cone.reversed

    @property
    def reversed(self) -> "Cone":
        """The same cone, its axis the other way."""
        return Cone(Axis(self.axis.position, -self.axis.direction), self.radius, -self.half_angle)

    def centred(self, points: Points) -> "Cone":
        """Its position at the mean height of the points."""
        height = float(self.axis.height(points).mean())
        radius = self.radius + height * math.tan(self.half_angle)
        return Cone(self.axis.at(height), radius, self.half_angle)

    def geometry(self) -> dict[str, Any]:
        """Its half angle, apex, and its axis away from there."""
        return {
            "half_angle": math.degrees(self.half_angle),
            "position": self.apex.tolist(),
            "axis": self.axis.direction.tolist(),
        }

    def extent(self, points: Points, area: float) -> dict[str, Any]:
        """Height along the axis, angle around it, and the radii at its ends."""
        height, (angle, full) = self.axis.height(points), swept(self.axis.angle(points))
        ends = [self.radius + float(end) * math.tan(self.half_angle) for end in (height.min(), height.max())]
        return {
            "height": spanned(height),
            "angle": angle,
            "full": full,
            "smallest_radius": max(0.0, ends[0]),
            "largest_radius": ends[1],
        }

    def placed(self, frame: Frame) -> "Cone":
        """From the unit frame to the world."""
        return Cone(self.axis.placed(frame), self.radius * frame.scale, self.half_angle)

    def sensible(self, reach: float) -> bool:
        """Whether it is neither as good as flat nor as good as a cylinder."""
        return bool(
            0.0 < self.radius < 20.0 * reach and math.radians(0.2) < self.half_angle < math.radians(89.0)
        )

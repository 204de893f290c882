"""The axis of a surface of revolution."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.measure.surface import Points, Step, Values, Vector, across, directions, unit


@dataclass(frozen=True, eq=False)
class Axis:
    """A line with a position on it. direction: of unit length."""

    position: Vector
    direction: Vector

    def radial(self, points: Points) -> Points:
        """From the line to the points, at right angles to it."""
        offset = points - self.position
        return offset - (offset @ self.direction)[:, None] * self.direction

    def distance(self, points: Points) -> Values:
        """ρ, of points from the line."""
        return np.linalg.norm(self.radial(points), axis=1)

    def height(self, points: Points) -> Values:
        """z, along the line from the position."""
        return (points - self.position) @ self.direction

    def outward(self, points: Points) -> Points:
        """The radial directions, at unit length."""
        return directions(self.radial(points))

    def angle(self, points: Points) -> Values:
        """Of points around the line, radians in (−π, π]."""
        first, second = across(self.direction)
        offset = points - self.position
        return np.arctan2(offset @ second, offset @ first)

    def flat(self, points: Points) -> Points:
        """Coordinates in the frame of the line: two across, z."""
        return (points - self.position) @ np.stack([*across(self.direction), self.direction], axis=1)

    def slopes(self, points: Points, normals: Points) -> Float64[np.ndarray, "n 5"]:
        """How distances from a surface about it change with the tilts and shifts of `moved`.

        A tilt towards e is a turn ω = a × e about the position: −ω·((p − position) × n); a shift is −e·n.
        """
        first, second = across(self.direction)
        turns = np.stack([np.cross(self.direction, first), np.cross(self.direction, second)], axis=1)
        shifts = np.stack([first, second, self.direction], axis=1)
        return -np.column_stack([np.cross(points - self.position, normals) @ turns, normals @ shifts])

    def moved(self, tilt: Step, shift: Vector) -> "Axis":
        """Tilted by two small angles, and shifted by two lengths across and one along it."""
        first, second = across(self.direction)
        position = self.position + shift[0] * first + shift[1] * second + shift[2] * self.direction
        return Axis(position, unit(self.direction + tilt[0] * first + tilt[1] * second))

    def at(self, height: float) -> "Axis":
        """The same line from another position on it."""
        return Axis(self.position + height * self.direction, self.direction)

    @property
    def upward(self) -> "Axis":
        """The same line, its direction's largest component positive."""
        sign = 1.0 if self.direction[np.argmax(np.abs(self.direction))] > 0.0 else -1.0
        return Axis(self.position, sign * self.direction)

    def placed(self, frame: Frame) -> "Axis":
        """From the unit frame to the world."""
        return Axis(frame.to_world(self.position[None])[0], self.direction)

"""Tori."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.measure.axis import Axis
from weingarten.measure.patch import Patch
from weingarten.measure.reach import swept
from weingarten.measure.surface import Pairs, Points, Step, Values, ball, unit


@dataclass(frozen=True, eq=False)
class Torus:
    """d = √((ρ − R)² + z²) − r, with R the ring's radius and r < R the tube's; the position is the centre."""

    axis: Axis
    major: float
    minor: float

    KIND: ClassVar[str] = "torus"
    FREEDOM: ClassVar[int] = 7

    @classmethod
    def guesses(cls, patch: Patch) -> "list[Torus]":
        """By either principal curvature as the tube's, and by the axis that all normals meet."""
        found = [cls.by_tube(patch, 1.0 / k) for k in np.median(patch.curvatures, axis=0) if abs(k) > 1e-3]
        return [torus for torus in [*found, cls.by_axis(patch)] if torus is not None]

    @classmethod
    def by_tube(cls, patch: Patch, radius: float) -> "Torus | None":
        """The centres of the tube, p − r n, lie on a circle."""
        centres = patch.points - radius * patch.normals
        mean = centres.mean(axis=0)
        basis = np.linalg.eigh((centres - mean).T @ (centres - mean))[1]
        flat = (centres - mean) @ basis[:, 1:]
        system = np.column_stack([2.0 * flat, np.ones(len(flat))])
        x, y, rest = np.linalg.lstsq(system, (flat**2).sum(axis=1), rcond=None)[0]
        major = float(np.sqrt(max(rest + x * x + y * y, 0.0)))
        return cls(Axis(mean + basis[:, 1:] @ np.array([x, y]), basis[:, 0]), major, float(abs(radius)))

    @classmethod
    def by_axis(cls, patch: Patch) -> "Torus | None":
        """The line (a, m = c × a) with n·m + (p × n)·a = 0 for all normals; a circle in its half-plane."""
        mean = patch.points.mean(axis=0)
        points = patch.points - mean
        size = max(float(np.abs(points).max()), 1e-300)
        lines = np.column_stack([np.cross(points / size, patch.normals), patch.normals])
        found = np.linalg.svd(lines, full_matrices=False)[2][-1]
        if np.linalg.norm(found[:3]) < 1e-6:
            return None
        found = found / np.linalg.norm(found[:3])
        axis = Axis(mean + size * np.cross(found[:3], found[3:]), unit(found[:3]))
        outward, rise = axis.outward(patch.points), axis.height(patch.points)
        profile = np.column_stack([axis.distance(patch.points), rise])
        facing = np.column_stack(
            [np.einsum("nd,nd->n", patch.normals, outward), patch.normals @ axis.direction]
        )
        centre, minor = ball(profile, facing)
        return cls(axis.at(float(centre[1])), float(centre[0]), abs(minor))

    def distance(self, points: Points) -> Values:
        """The signed distance, positive outside of the tube."""
        return np.hypot(self.axis.distance(points) - self.major, self.axis.height(points)) - self.minor

    def normals(self, points: Points) -> Points:
        """Away from the middle of the tube."""
        rho, rise = self.axis.distance(points) - self.major, self.axis.height(points)
        length = np.maximum(np.hypot(rho, rise), 1e-300)
        outward = self.axis.outward(points)
        return (rho / length)[:, None] * outward + (rise / length)[:, None] * self.axis.direction

    def curvatures(self, points: Points) -> Pairs:
        """(ρ − R)/(r ρ) around the ring and 1/r around the tube."""
        rho = np.maximum(self.axis.distance(points), 1e-9)
        return np.column_stack([(rho - self.major) / (self.minor * rho), np.full(len(rho), 1.0 / self.minor)])

    def slopes(self, points: Points) -> Float64[np.ndarray, "n p"]:
        """By the axis' tilts and shifts; by R, −n·(outward); by r, −1."""
        normals = self.normals(points)
        ring = -np.einsum("nd,nd->n", normals, self.axis.outward(points))
        return np.column_stack([self.axis.slopes(points, normals), ring, np.full(len(points), -1.0)])

    def moved(self, step: Step) -> "Torus":
        """Tilted by two angles, shifted by three lengths, and larger in both radii."""
        axis = self.axis.moved(step[:2], step[2:5])
        return Torus(axis, self.major + float(step[5]), self.minor + float(step[6]))

    def centred(self, points: Points) -> "Torus":
        """As it is."""
        return self

    def geometry(self) -> dict[str, Any]:
        """Its radii, centre and axis."""
        axis = self.axis.upward
        return {
            "major_radius": self.major,
            "minor_radius": self.minor,
            "position": axis.position.tolist(),
            "axis": axis.direction.tolist(),
        }

    def extent(self, points: Points, area: float) -> dict[str, Any]:
        """Angle around the axis, and around the tube."""
        angle, full = swept(self.axis.angle(points))
        around = np.arctan2(self.axis.height(points), self.axis.distance(points) - self.major)
        return {"angle": angle, "full": full, "tube_angle": swept(around)[0]}

    def placed(self, frame: Frame) -> "Torus":
        """From the unit frame to the world."""
        return Torus(self.axis.placed(frame), self.major * frame.scale, self.minor * frame.scale)

    def sensible(self, reach: float) -> bool:
        """Whether it is a ring, not as good as a sphere, a cylinder or flat."""
        return bool(0.0 < self.minor < self.major < 20.0 * reach and self.minor < 2.0 * reach)

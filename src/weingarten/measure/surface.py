"""What the five kinds of surface have in common, and small geometry that they share.

Lengths are those of the frame that the points are in. A step is a vector of as many small numbers as a
surface has degrees of freedom: lengths, and angles in radians.
"""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.measure.patch import Patch

Points = Float64[np.ndarray, "n 3"]
Vector = Float64[np.ndarray, " 3"]
Values = Float64[np.ndarray, " n"]
Pairs = Float64[np.ndarray, "n 2"]
Step = Float64[np.ndarray, " p"]


@runtime_checkable
class Surface(Protocol):
    """A surface without ends, of a kind."""

    KIND: ClassVar[str]
    FREEDOM: ClassVar[int]

    @classmethod
    def guesses(cls, patch: Patch) -> Sequence["Surface"]:
        """What surface of this kind a patch may be a part of; none where it cannot be one."""
        ...

    def distance(self, points: Points) -> Values:
        """Signed, positive on the side that the normals point to."""
        ...

    def normals(self, points: Points) -> Points:
        """Gradient of the distance: away from axis or centre."""
        ...

    def curvatures(self, points: Points) -> Pairs:
        """κ₁ ≤ κ₂ at points on it, positive where it is convex, one over length."""
        ...

    def slopes(self, points: Points) -> Float64[np.ndarray, "n p"]:
        """Derivatives of the distance by a step of `moved`, at no step."""
        ...

    def moved(self, step: Step) -> "Surface":
        """A surface nearby."""
        ...

    def centred(self, points: Points) -> "Surface":
        """The same surface, its position where these points are."""
        ...

    def geometry(self) -> dict[str, Any]:
        """Its sizes, where it is and how it lies, as plain values for JSON; angles in degrees."""
        ...

    def extent(self, points: Points, area: float) -> dict[str, Any]:
        """How much of it there is, told from points on it and its area; angles in degrees."""
        ...

    def placed(self, frame: Frame) -> "Surface":
        """From the unit frame to the world."""
        ...

    def sensible(self, reach: float) -> bool:
        """Whether its sizes are those of a surface of this kind, on a part that is `reach` across."""
        ...


def unit(vector: Vector) -> Vector:
    """Of length 1."""
    return vector / np.linalg.norm(vector)


def across(direction: Vector) -> tuple[Vector, Vector]:
    """Two unit vectors at right angles to a unit vector and to each other (Duff et al. 2017, eq. 4)."""
    x, y, z = map(float, direction)
    sign = math.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return np.array([1.0 + sign * x * x * a, sign * b, -sign * x]), np.array([b, sign + y * y * a, -y])


def directions(vectors: Points) -> Points:
    """Every vector at unit length."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)


def ball(
    points: Float64[np.ndarray, "n d"], normals: Float64[np.ndarray, "n d"]
) -> tuple[Float64[np.ndarray, " d"], float]:
    """Centre c and radius r of min Σ ‖p − c − r n‖², a circle or sphere; r < 0 if its normals point in."""
    mean, facing = points.mean(axis=0), normals.mean(axis=0)
    turned = normals - facing
    radius = float(((points - mean) * turned).sum() / max((turned**2).sum(), 1e-300))
    return mean - radius * facing, radius

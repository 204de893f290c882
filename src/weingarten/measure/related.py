"""Which primitives are in one plane, and which about one axis."""

from dataclasses import replace

import numpy as np

from weingarten.measure.cone import Cone
from weingarten.measure.cylinder import Cylinder
from weingarten.measure.plane import Plane
from weingarten.measure.primitive import Primitive
from weingarten.measure.torus import Torus


def related(primitives: list[Primitive], tolerance: float) -> tuple[Primitive, ...]:
    """With the numbers of those that share a plane or an axis with each, to within the tolerance."""
    return tuple(
        replace(
            one,
            same_plane=numbers(primitives, n, tolerance, in_one_plane),
            coaxial=numbers(primitives, n, tolerance, about_one_axis),
        )
        for n, one in enumerate(primitives)
    )


def numbers(primitives: list[Primitive], own: int, tolerance: float, same) -> tuple[int, ...]:
    """Of the others that are the same in some way."""
    return tuple(
        n
        for n, other in enumerate(primitives)
        if n != own and same(primitives[own], other, tolerance) and same(other, primitives[own], tolerance)
    )


def in_one_plane(one: Primitive, other: Primitive, tolerance: float) -> bool:
    """Whether the middle of each face, and points half its length away, are in the other's plane."""
    a, b = one.surface, other.surface
    if not isinstance(a, Plane) or not isinstance(b, Plane) or a.normal @ b.normal <= 0.0:
        return False
    lean = float(np.linalg.norm(np.cross(a.normal, b.normal))) * 0.5 * one.extent["length"]
    return abs(float(b.distance(a.position[None])[0])) + lean <= tolerance


def about_one_axis(one: Primitive, other: Primitive, tolerance: float) -> bool:
    """Whether the ends of the one are on the axis of the other."""
    a, b = one.surface, other.surface
    if not isinstance(a, Cylinder | Cone | Torus) or not isinstance(b, Cylinder | Cone | Torus):
        return False
    reach = 0.5 * one.extent.get("height", 0.0)
    ends = a.axis.position + np.outer([-reach, reach], a.axis.direction)
    lean = float(np.linalg.norm(np.cross(a.axis.direction, b.axis.direction)))
    size = a.major if isinstance(a, Torus) else a.radius
    return float(b.axis.distance(ends).max()) + lean * size <= tolerance

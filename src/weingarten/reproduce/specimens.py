"""The exact solids of Figure 1, about the origin, and where on each the curvatures are read."""

import math
from dataclasses import dataclass

from weingarten.calculus.exact import (
    Box,
    CappedCylinder,
    Cone,
    Difference,
    Intersection,
    Plane,
    Shape,
    Sphere,
    Torus,
    Vector,
)

FRONT = (math.cos(math.radians(-58.0)), math.sin(math.radians(-58.0)))
"""Horizontal direction of the viewer, as that of `report.camera`."""


@dataclass(frozen=True)
class Mark:
    """A place near the surface, and what the averaged ODW residual is there as a formula."""

    place: Vector
    formula: str


@dataclass(frozen=True)
class Specimen:
    """A solid within the cube [−REACH, REACH]³, unit lengths."""

    name: str
    shape: Shape
    marks: tuple[Mark, ...]


REACH = 1.3


def ahead(radius: float, height: float = 0.0) -> Vector:
    """At that distance from the upright axis, towards the viewer; behind the axis if negative."""
    return (radius * FRONT[0], radius * FRONT[1], height)


SPECIMENS = (
    Specimen("box", Box(half=(0.8, 0.8, 0.8)), (Mark((0.15, -0.8, 0.1), "0"),)),
    Specimen(
        "cylinder",
        CappedCylinder(radius=1.0, half_height=0.85),
        (Mark(ahead(1.0, -0.1), r"1/(\pi r)"),),
    ),
    Specimen(
        "cone",
        Intersection(
            (Cone((0.0, 0.0, 1.1), (0.0, 0.0, -1.0), math.pi / 6), Plane((0.0, 0.0, -0.8), (0.0, 0.0, -1.0)))
        ),
        (Mark(ahead(0.5, 1.1 - 0.5 * math.sqrt(3.0)), r"\cos\alpha/(\pi\rho)"),),
    ),
    Specimen("sphere", Sphere(radius=1.0), (Mark(ahead(0.85, 0.35), "0"),)),
    Specimen(
        "torus",
        Torus(ring=0.8, tube=0.4),
        (Mark(ahead(1.2), r"R/(\pi r \rho)"), Mark(ahead(-0.4), r"R/(\pi r \rho)")),
    ),
    Specimen(
        "groove",
        Difference(CappedCylinder(radius=1.0, half_height=0.75), Torus(ring=1.0, tube=0.5)),
        (Mark(ahead(0.5), r"R/(\pi r \rho)"),),
    ),
)

"""Area and uniform draws for the surfaces of the exact primitives, from which a solid's surface is sampled.

Lengths are in the primitive's own unit; every draw takes its randomness from the generator it is given.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

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
    Union,
)

Points = Float64[np.ndarray, "n 3"]
Vector = Float64[np.ndarray, " 3"]
Draw = Callable[[np.random.Generator, int], Points]


@dataclass(frozen=True)
class Patch:
    """A piece of surface: its area, and a function of (generator, n) that draws n points uniform by area."""

    area: float
    draw: Draw


def primitives(solid: Shape) -> list[Shape]:
    """The primitives that a combination is made of, in order."""
    if isinstance(solid, Union | Intersection):
        return [leaf for part in solid.parts for leaf in primitives(part)]
    if isinstance(solid, Difference):
        return primitives(solid.body) + primitives(solid.tool)
    return [solid]


def patches(primitive: Shape, centre: Vector, reach: float) -> list[Patch]:
    """The primitive's whole surface; of a plane or cone, a part that covers the ball (centre, reach).

    Raises TypeError for a primitive that no patch is written for.
    """
    match primitive:
        case Box():
            return _box(np.asarray(primitive.centre), np.asarray(primitive.half))
        case CappedCylinder():
            return _capped_cylinder(primitive)
        case Sphere():
            return [_sphere(np.asarray(primitive.centre), primitive.radius)]
        case Torus():
            return [_torus(primitive)]
        case Cone():
            slant = float(np.linalg.norm(centre - primitive.apex)) + reach
            return [_cone(primitive, slant)]
        case Plane():
            axis = _basis(primitive.normal)[2]
            foot = centre - axis * float((centre - primitive.centre) @ axis)
            return [_disc(foot, _basis(primitive.normal), reach)]
        case _:
            raise TypeError(f"no patch is written for {type(primitive).__name__}")


def _basis(axis: tuple[float, float, float]) -> Float64[np.ndarray, "3 3"]:
    """Rows e₁, e₂, e₃: orthonormal, right-handed, e₃ along the axis."""
    third = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
    helper = np.eye(3)[np.argmin(np.abs(third))]
    first = np.cross(helper, third)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(third, first), third])


def _turn(
    random: np.random.Generator, count: int
) -> tuple[Float64[np.ndarray, " n"], Float64[np.ndarray, " n"]]:
    """cos φ, sin φ of uniform angles."""
    angle = random.uniform(0, 2 * math.pi, count)
    return np.cos(angle), np.sin(angle)


def _box(centre: Vector, half: Vector) -> list[Patch]:
    def face(axis: int, sign: float) -> Patch:
        def draw(random: np.random.Generator, count: int) -> Points:
            points = centre + half * random.uniform(-1, 1, (count, 3))
            points[:, axis] = centre[axis] + sign * half[axis]
            return points

        return Patch(4 * float(np.delete(half, axis).prod()), draw)

    return [face(axis, sign) for axis in range(3) for sign in (-1.0, 1.0)]


def _disc(centre: Vector, basis: Float64[np.ndarray, "3 3"], radius: float) -> Patch:
    def draw(random: np.random.Generator, count: int) -> Points:
        cos, sin = _turn(random, count)
        rho = radius * np.sqrt(random.random(count))
        return centre + np.stack([rho * cos, rho * sin], axis=1) @ basis[:2]

    return Patch(math.pi * radius**2, draw)


def _capped_cylinder(shape: CappedCylinder) -> list[Patch]:
    centre, basis = np.asarray(shape.centre), _basis(shape.axis)
    radius, half = shape.radius, shape.half_height

    def side(random: np.random.Generator, count: int) -> Points:
        cos, sin = _turn(random, count)
        return (
            centre
            + np.stack([radius * cos, radius * sin, half * random.uniform(-1, 1, count)], axis=1) @ basis
        )

    ends = [_disc(centre + sign * half * basis[2], basis, radius) for sign in (-1.0, 1.0)]
    return [Patch(4 * math.pi * radius * half, side), *ends]


def _sphere(centre: Vector, radius: float) -> Patch:
    def draw(random: np.random.Generator, count: int) -> Points:
        directions = random.standard_normal((count, 3))
        return centre + radius * directions / np.linalg.norm(directions, axis=1, keepdims=True)

    return Patch(4 * math.pi * radius**2, draw)


def _torus(shape: Torus) -> Patch:
    """The angle θ round the tube has density ∝ 1 + (r/R) cos θ: a uniform θ, kept with probability half that
    and replaced by π − θ otherwise, has it exactly."""
    centre, basis, ring, tube = np.asarray(shape.centre), _basis(shape.axis), shape.ring, shape.tube

    def draw(random: np.random.Generator, count: int) -> Points:
        along, up = _turn(random, count)
        kept = random.random(count) < (1 + tube / ring * along) / 2
        rho = ring + tube * np.where(kept, along, -along)
        cos, sin = _turn(random, count)
        return centre + np.stack([rho * cos, rho * sin, tube * up], axis=1) @ basis

    return Patch(4 * math.pi**2 * ring * tube, draw)


def _cone(shape: Cone, slant: float) -> Patch:
    apex, basis = np.asarray(shape.apex), _basis(shape.axis)
    sine, cosine = math.sin(shape.half_angle), math.cos(shape.half_angle)

    def draw(random: np.random.Generator, count: int) -> Points:
        distance = slant * np.sqrt(random.random(count))
        cos, sin = _turn(random, count)
        rho = distance * sine
        return apex + np.stack([rho * cos, rho * sin, distance * cosine], axis=1) @ basis

    return Patch(math.pi * sine * slant**2, draw)

"""Signed distance fields in closed form, negative inside, with their principal curvatures.

Every shape is a field: called with points (n, 3) of any float dtype and device, it returns (n,), and
autograd differentiates it as often as wanted. `curvatures` takes points on the surface and returns
(n, 2), the principal curvatures k₁ ≥ k₂, the two tangential eigenvalues of the distance field's Hessian:
positive on a convex surface (1/r, 1/r on a sphere of radius r). Lengths are in the points' own unit.

Plane, Sphere, Cylinder, CappedCylinder, Cone, Torus and Box are exact distances everywhere. Union,
Intersection and Difference take minima and maxima: exact zero sets and signs, ‖∇f‖ = 1 almost everywhere,
but away from the surface only a bound on the distance (Quílez, *Distance functions*).
"""

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import torch
from jaxtyping import Float
from torch import Tensor

Vector = tuple[float, float, float]
ORIGIN: Vector = (0.0, 0.0, 0.0)
UPWARD: Vector = (0.0, 0.0, 1.0)


@runtime_checkable
class Shape(Protocol):
    """A signed distance field, or a combination of some, with known curvatures."""

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The field at the points."""
        ...

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """k₁ ≥ k₂ at points on the surface."""
        ...


def _length(vectors: Float[Tensor, "n d"]) -> Float[Tensor, " n"]:
    """Euclidean length, with derivatives of zero instead of none at the zero vector."""
    squared = (vectors * vectors).sum(dim=-1)
    zero = squared == 0
    return torch.where(zero, torch.zeros_like(squared), torch.where(zero, 1.0, squared).sqrt())


def _direction(points: Float[Tensor, "n 3"], axis: Vector) -> Float[Tensor, " 3"]:
    return points.new_tensor(axis) / math.hypot(*axis)


def _around(
    points: Float[Tensor, "n 3"], centre: Vector, axis: Vector
) -> tuple[Float[Tensor, " n"], Float[Tensor, " n"]]:
    """Distance ρ from the axis through the centre, and height z along it."""
    offset, direction = points - points.new_tensor(centre), _direction(points, axis)
    height = offset @ direction
    return _length(offset - height[:, None] * direction), height


def _flat(points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
    return points.new_zeros(len(points), 2)


@dataclass(frozen=True)
class Plane:
    """f = n·(x − centre): the half-space below the plane is inside."""

    centre: Vector = ORIGIN
    normal: Vector = UPWARD

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The signed distance."""
        return (points - points.new_tensor(self.centre)) @ _direction(points, self.normal)

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """0, 0."""
        return _flat(points)


@dataclass(frozen=True)
class Sphere:
    """f = ‖x − centre‖ − r."""

    centre: Vector = ORIGIN
    radius: float = 1.0

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The signed distance."""
        return _length(points - points.new_tensor(self.centre)) - self.radius

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """1/r, 1/r."""
        return _flat(points) + 1.0 / self.radius


@dataclass(frozen=True)
class Cylinder:
    """f = ρ − r: without ends."""

    centre: Vector = ORIGIN
    axis: Vector = UPWARD
    radius: float = 1.0

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The signed distance."""
        return _around(points, self.centre, self.axis)[0] - self.radius

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """1/r, 0."""
        return _flat(points) + points.new_tensor([1.0 / self.radius, 0.0])


@dataclass(frozen=True)
class CappedCylinder:
    """The solid ρ ≤ r, |z| ≤ half_height; q = (ρ − r, |z| − half_height), f = ‖max(q, 0)‖ + min(max q, 0)."""

    centre: Vector = ORIGIN
    axis: Vector = UPWARD
    radius: float = 1.0
    half_height: float = 1.0

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The signed distance."""
        return _boxed(self._excess(points))

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """1/r, 0 on the side; 0, 0 on the ends."""
        side, end = self._excess(points).unbind(dim=-1)
        bent = points.new_tensor([1.0 / self.radius, 0.0])
        return torch.where((side > end)[:, None], bent, points.new_zeros(2))

    def _excess(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        rho, height = _around(points, self.centre, self.axis)
        return torch.stack([rho - self.radius, height.abs() - self.half_height], dim=-1)


@dataclass(frozen=True)
class Cone:
    """The solid around the axis ray from the apex, up to the half angle α (radians, below π/2), without end.

    f = ρ cos α − z sin α, or √(ρ² + z²) where the apex is closest: z cos α + ρ sin α < 0.
    """

    apex: Vector = ORIGIN
    axis: Vector = UPWARD
    half_angle: float = math.pi / 6

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The signed distance."""
        rho, height = _around(points, self.apex, self.axis)
        cos, sin = math.cos(self.half_angle), math.sin(self.half_angle)
        beyond = height * cos + rho * sin < 0
        return torch.where(beyond, _length(points - points.new_tensor(self.apex)), rho * cos - height * sin)

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """cos α / ρ, 0; infinite at the apex."""
        bent = math.cos(self.half_angle) / _around(points, self.apex, self.axis)[0]
        return torch.stack([bent, torch.zeros_like(bent)], dim=-1)


@dataclass(frozen=True)
class Torus:
    """f = √((ρ − R)² + z²) − r, with R the ring's radius and r < R the tube's."""

    centre: Vector = ORIGIN
    axis: Vector = UPWARD
    ring: float = 1.0
    tube: float = 0.25

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The signed distance."""
        rho, height = _around(points, self.centre, self.axis)
        return _length(torch.stack([rho - self.ring, height], dim=-1)) - self.tube

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """1/r around the tube and (ρ − R)/(r ρ) around the ring: negative on the inner half."""
        rho, _ = _around(points, self.centre, self.axis)
        ring = (rho - self.ring) / (self.tube * rho)
        return torch.stack([torch.full_like(ring, 1.0 / self.tube), ring], dim=-1)


@dataclass(frozen=True)
class Box:
    """Axis-aligned: q = |x − centre| − half, f = ‖max(q, 0)‖ + min(max q, 0)."""

    centre: Vector = ORIGIN
    half: Vector = (1.0, 1.0, 1.0)

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The signed distance."""
        return _boxed((points - points.new_tensor(self.centre)).abs() - points.new_tensor(self.half))

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """0, 0 on the faces; not defined on the edges."""
        return _flat(points)


def _boxed(excess: Float[Tensor, "n d"]) -> Float[Tensor, " n"]:
    """‖max(q, 0)‖ + min(max q, 0)."""
    return _length(excess.clamp(min=0)) + excess.amax(dim=-1).clamp(max=0)


@dataclass(frozen=True)
class Union:
    """f = min fᵢ."""

    parts: tuple[Shape, ...]

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The smallest of the parts' fields."""
        return torch.stack([part(points) for part in self.parts]).amin(dim=0)

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """Those of the part whose surface the point is on."""
        active = torch.stack([part(points) for part in self.parts]).argmin(dim=0)
        return _chosen(self.parts, points, active)


@dataclass(frozen=True)
class Intersection:
    """f = max fᵢ."""

    parts: tuple[Shape, ...]

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The largest of the parts' fields."""
        return torch.stack([part(points) for part in self.parts]).amax(dim=0)

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """Those of the part whose surface the point is on."""
        active = torch.stack([part(points) for part in self.parts]).argmax(dim=0)
        return _chosen(self.parts, points, active)


@dataclass(frozen=True)
class Difference:
    """f = max(f_body, −f_tool)."""

    body: Shape
    tool: Shape

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The body's field, or the tool's with its sign turned."""
        return torch.maximum(self.body(points), -self.tool(points))

    def curvatures(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 2"]:
        """The body's k₁, k₂, or −k₂, −k₁ of the tool."""
        on_body = self.body(points) > -self.tool(points)
        return torch.where(
            on_body[:, None], self.body.curvatures(points), -self.tool.curvatures(points).flip(1)
        )


def _chosen(parts: tuple[Shape, ...], points: Float[Tensor, "n 3"], active: Tensor) -> Float[Tensor, "n 2"]:
    every = torch.stack([part.curvatures(points) for part in parts])
    return every[active, torch.arange(len(points), device=points.device)]

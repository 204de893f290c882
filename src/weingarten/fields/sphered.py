"""A network whose output is a squared distance at first, as a distance (DiGS, Ben-Shabat et al. 2022).

    f = φ(g),   φ(g) = s (sgn(g) √(|g| + ε) − √ε sgn(g) − ρ)

with g the inner network; s and ρ make it c (‖x‖ − r) at ‖x‖ = r when it is made. ‖x‖ → 0 has no derivative; ε
rounds it off. All jets of f are those of g and three derivatives of φ: ∇f = φ' ∇g, H_f = φ' H_g + φ'' ∇g
∇gᵀ.
"""

import math
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.fields.quadratic import QuadraticSiren
from weingarten.fields.siren import Siren

ROUNDING = 1e-4
"""ε, of g, which is ⅛ π² times a squared unit length at first: within about a hundredth of the origin, and
wherever g is about 0 later, the root is a smooth one. The authors' is 10⁻⁸; its slope is up to 5,000."""

DIRECTIONS = 512
"""Directions in which the beginning is measured."""


class Outer(NamedTuple):
    """φ and its derivatives at some g."""

    value: Float[Tensor, "..."]
    first: Float[Tensor, "..."]
    second: Float[Tensor, "..."]


class Sphered(nn.Module):
    """f: (n, 3) → (n,), slope · (‖x‖ − radius) at first where the inner network has been so initialised.

    inner: a SIREN after `weingarten.fields.initialise`, or one of quadratic layers made of it.
    radius: unit lengths.
    """

    scale: Tensor
    offset: Tensor

    def __init__(self, inner: Siren | QuadraticSiren, radius: float = 1.0, slope: float = 1.0) -> None:
        super().__init__()
        self.inner = inner
        self.register_buffer("scale", torch.ones(()))
        self.register_buffer("offset", torch.zeros(()))
        self.calibrate(radius, slope)

    @property
    def square_matrices(self) -> list[nn.Parameter]:
        """The inner network's square matrices."""
        return self.inner.square_matrices

    @torch.no_grad()
    def calibrate(self, radius: float, slope: float) -> None:
        """Choose s and ρ: mean f zero at the radius, that mean radial slope about it."""
        directions = fibonacci(DIRECTIONS).to(self.offset)
        near, at, far = (self.root(self.inner(k * radius * directions)).mean() for k in (0.9, 1.0, 1.1))
        self.scale.copy_(0.2 * radius * slope / (far - near))
        self.offset.copy_(at)

    def root(self, g: Float[Tensor, "..."]) -> Float[Tensor, "..."]:
        """sgn(g) (√(|g| + ε) − √ε): differentiable everywhere."""
        return g.sign() * ((g.abs() + ROUNDING).sqrt() - math.sqrt(ROUNDING))

    def outer(self, g: Float[Tensor, "..."]) -> Outer:
        """φ, φ', φ'' at g. φ' is positive, at most s / (2 √ε); φ'' jumps at g = 0, where it counts as 0."""
        root = (g.abs() + ROUNDING).sqrt()
        return Outer(
            self.scale * (self.root(g) - self.offset),
            self.scale * 0.5 / root,
            -self.scale * 0.25 * g.sign() / root**3,
        )

    def forward(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """Field values at points of the unit frame."""
        return self.scale * (self.root(self.inner(points)) - self.offset)


def fibonacci(count: int) -> Float[Tensor, "count 3"]:
    """Directions spread evenly over the sphere, always the same."""
    index = torch.arange(count, dtype=torch.float64)
    height = 1.0 - (2.0 * index + 1.0) / count
    turn = index * math.pi * (3.0 - math.sqrt(5.0))
    ring = (1.0 - height * height).sqrt()
    return torch.stack([ring * turn.cos(), ring * turn.sin(), height], dim=1)

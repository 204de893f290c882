"""What a term may know of a field at a point: value, gradient, and its Hessian in a frame of the surface.

Symbols, used in every file of `calculus` and `terms`: f the field, g = ∇f, H its Hessian, n = g/‖g‖,
(u, v) an orthonormal frame of the tangent plane, all in the unit frame. The frame is a constant for the
optimiser: no cotangent flows through n, u, v. Arrays of an ensemble have its members after the
points: shapes (n, m), where one field has (n,), and (n, m, 3).
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import torch
from jaxtyping import Float
from torch import Tensor

VALUE, GRADIENT, TANGENT, HESSIAN = range(4)
"""Orders of a jet: value alone; and gradient; and the tangent block uᵀHu, uᵀHv, vᵀHv; and the rest of H."""

TENSORS = (1, 2, 5, 8)
"""How many of a jet's arrays there are, by its order."""

PAIRS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
"""Directions, of (u, v, n), of a jet's second derivatives, in order; a tangent block has the first three."""


@dataclass(frozen=True)
class Jet:
    """Derivatives of a field at n points, or of m fields at n points each; what was not asked for is None.

    value: f, unit lengths. gradient: ∇f, no unit. uu, uv, vv: uᵀHu, uᵀHv, vᵀHv, one over unit length; un, vn,
    nn: uᵀHn, vᵀHn, nᵀHn.
    """

    value: Float[Tensor, "n *m"]
    gradient: Float[Tensor, "n *m 3"] | None = None
    uu: Float[Tensor, "n *m"] | None = None
    uv: Float[Tensor, "n *m"] | None = None
    vv: Float[Tensor, "n *m"] | None = None
    un: Float[Tensor, "n *m"] | None = None
    vn: Float[Tensor, "n *m"] | None = None
    nn: Float[Tensor, "n *m"] | None = None

    def split(self, sizes: list[int]) -> "list[Jet]":
        """The jets of consecutive points, so many each."""
        return [Jet(*row) for row in zip(*(tensor.split(sizes) for tensor in self.tensors), strict=True)]

    @property
    def tensors(self) -> tuple[Tensor, ...]:
        """All that was asked for."""
        block = (self.uu, self.uv, self.vv, self.un, self.vn, self.nn)
        return tuple(field for field in (self.value, self.gradient, *block) if field is not None)

    def detached(self) -> "Jet":
        """The same numbers as leaves of a graph of their own."""
        return Jet(*(tensor.detach().requires_grad_() for tensor in self.tensors))

    @property
    def slope(self) -> Float[Tensor, "n *m 3"]:
        """The gradient, where it is known to have been asked for."""
        if self.gradient is None:
            raise ValueError("this jet was evaluated without its gradient; ask for order GRADIENT or above")
        return self.gradient

    @property
    def shape_operator(self) -> tuple[Float[Tensor, "n *m"], Float[Tensor, "n *m"], Float[Tensor, "n *m"]]:
        """S₁₁, S₁₂, S₂₂ of S = (u v)ᵀ H (u v) / ‖∇f‖, the Weingarten map in the frame."""
        if self.uu is None or self.uv is None or self.vv is None:
            raise ValueError("this jet was evaluated without its tangent block; ask for order TANGENT")
        norm = self.slope.norm(dim=-1).clamp_min(SMALLEST_NORM)
        return self.uu / norm, self.uv / norm, self.vv / norm

    @property
    def second(self) -> tuple[Float[Tensor, "n *m"], ...]:
        """uᵀHu, uᵀHv, vᵀHv, uᵀHn, vᵀHn, nᵀHn, where all of H is known to have been asked for."""
        if self.nn is None:
            raise ValueError("this jet was evaluated without its Hessian; ask for order HESSIAN")
        return self.tensors[2:]

    @property
    def hessian(self) -> Float[Tensor, "n *m 3 3"]:
        """H in the frame: (u v n)ᵀ H (u v n), of which trace and determinant are those of H."""
        uu, uv, vv, un, vn, nn = self.second
        rows = (torch.stack(row, dim=-1) for row in ((uu, uv, un), (uv, vv, vn), (un, vn, nn)))
        return torch.stack(tuple(rows), dim=-2)


SMALLEST_NORM = 1e-12
"""Guard of every division by ‖∇f‖: a critical point of the field gives a large residual, never a NaN."""


@runtime_checkable
class Calculus(Protocol):
    """A way of differentiating a field: analytic, by autograd, or by finite differences."""

    def __call__(
        self, points: Float[Tensor, "n *m 3"], order: int, angles: Float[Tensor, "n *m"] | None = None
    ) -> Jet:
        """The jet of `order` at `points`; `angles` turn the tangent frames, radians (from TANGENT on)."""
        ...


@runtime_checkable
class Progressive(Protocol):
    """A calculus that is another one at every step."""

    def at(self, t: float) -> Calculus:
        """That at progress t."""
        ...


def directions(
    gradient: Float[Tensor, "n *m 3"], angles: Float[Tensor, "n *m"], order: int
) -> tuple[Float[Tensor, "n *m 3"], ...]:
    """(u, v) of order TANGENT, (u, v, n) of order HESSIAN; detached from the graph."""
    return (*tangent_frame(gradient, angles), unit_normal(gradient))[: 2 if order == TANGENT else 3]


def unit_normal(gradient: Float[Tensor, "n *m 3"]) -> Float[Tensor, "n *m 3"]:
    """n = ∇f/‖∇f‖, detached from the graph."""
    with torch.no_grad():
        return gradient / gradient.norm(dim=-1, keepdim=True).clamp_min(SMALLEST_NORM)


def tangent_frame(
    gradient: Float[Tensor, "n *m 3"], angles: Float[Tensor, "n *m"]
) -> tuple[Float[Tensor, "n *m 3"], Float[Tensor, "n *m 3"]]:
    """Orthonormal (u, v) ⟂ gradient, turned by `angles` about it; detached from the graph.

    The frame at angle 0 is that of Duff et al. 2017, "Building an Orthonormal Basis, Revisited", eq. 4.
    """
    with torch.no_grad():
        x, y, z = unit_normal(gradient).unbind(-1)
        sign = 1.0 - 2.0 * (z < 0).to(z)
        a = -1.0 / (sign + z)
        b = x * y * a
        e1 = torch.stack([1.0 + sign * x * x * a, sign * b, -sign * x], dim=-1)
        e2 = torch.stack([b, sign + y * y * a, -y], dim=-1)
        cos, sin = angles.cos().unsqueeze(-1), angles.sin().unsqueeze(-1)
        return cos * e1 + sin * e2, cos * e2 - sin * e1

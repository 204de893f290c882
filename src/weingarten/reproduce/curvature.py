"""Principal curvatures of exact fields, by autograd: none of the closed forms of `calculus.exact` is used.

κ₁ ≥ κ₂ are the eigenvalues of the tangent block S of a jet, with m = (S₁₁ + S₂₂)/2 and
d = √((S₁₁ − S₂₂)² + 4 S₁₂²) = κ₁ − κ₂:  κ₁,₂ = m ± d/2. The residual of the off-diagonal Weingarten term in
a frame turned by θ from the principal one is ½ d |sin 2θ|; its mean over all frames is d/π: zero
on planes and spheres, 1/(πr) on a cylinder.
"""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Float64, Int64
from torch import Tensor, nn

from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.exact import Shape
from weingarten.calculus.jet import GRADIENT, TANGENT

Points = Float64[np.ndarray, "n 3"]
Numbers = Float64[np.ndarray, " n"]

REGIMES = ("planar", "parabolic", "elliptic", "hyperbolic")
FLAT = 1e-6
"""|κ| up to this, one over unit length, counts as zero: rounding leaves 1e-12 of curvatures about one."""

ITERATIONS = 4


class Field(nn.Module):
    """An exact field as the module that `Autodiff` differentiates."""

    def __init__(self, shape: Shape) -> None:
        super().__init__()
        self.shape = shape

    def forward(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The field at the points."""
        return self.shape(points)


@dataclass(frozen=True)
class Curvatures:
    """What is known at n points of a surface.

    normals: unit, outwards. first, second: κ₁ ≥ κ₂, one over unit length, positive where convex.
    """

    normals: Points
    first: Numbers
    second: Numbers

    @property
    def residual(self) -> Numbers:
        """|κ₁ − κ₂|/π: the off-diagonal Weingarten residual, mean over all tangent frames."""
        return (self.first - self.second) / np.pi

    @property
    def regime(self) -> Int64[np.ndarray, " n"]:
        """Index in REGIMES: both zero, one zero, of one sign, of two signs."""
        first, second = np.abs(self.first) > FLAT, np.abs(self.second) > FLAT
        bent = np.where(self.first * self.second > 0, 2, 3)
        return np.where(first & second, bent, np.where(first | second, 1, 0)).astype(np.int64)


def on_surface(shape: Shape, points: Points) -> Points:
    """The points after a few Newton steps x − f ∇f/‖∇f‖² towards the zero set."""
    calculus, x = Autodiff(Field(shape)), torch.from_numpy(points)
    for _ in range(ITERATIONS):
        jet = calculus(x, GRADIENT)
        slope = jet.slope
        x = (x - slope * (jet.value / (slope * slope).sum(-1).clamp_min(1e-12))[:, None]).detach()
    return x.numpy()


def curvatures(shape: Shape, points: Points) -> Curvatures:
    """Those of the field's level sets through the points, unit lengths, from its second derivatives."""
    jet = Autodiff(Field(shape))(torch.from_numpy(points), TANGENT)
    S11, S12, S22 = (entry.detach().numpy() for entry in jet.shape_operator)
    slope = jet.slope.detach().numpy()
    mean, gap = (S11 + S22) / 2, np.hypot(S11 - S22, 2 * S12)
    length = np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-12)
    return Curvatures(slope / length, mean + gap / 2, mean - gap / 2)

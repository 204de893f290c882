"""The smaller principal curvature: of CAD's surfaces, nearly all are flat in one direction at least.

min(|κ₁|, |κ₂|) is zero on planes, cylinders, cones and every other developable surface, as Gaussian curvature
is, but a length's inverse instead of its square: a fillet of radius r that meets a face in a torus is not
punished the more the smaller it is. New in this package; for the price of the off-diagonal Weingarten term.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import TANGENT, Jet
from weingarten.scan.sample import NEAR, Sample
from weingarten.terms.term import Term

SMALLEST_SPREAD = 1e-12
"""Guard of a root whose derivative is infinite where both curvatures are equal; one over unit length."""


def principal_curvatures(jet: Jet) -> tuple[Float[Tensor, "n *m"], Float[Tensor, "n *m"]]:
    """κ₁ ≤ κ₂ = ½ (S₁₁ + S₂₂) ∓ √(¼ (S₁₁ − S₂₂)² + S₁₂²), one over unit length; 1/r on a sphere outward."""
    s11, s12, s22 = jet.shape_operator
    squares = (0.5 * (s11 - s22)).square() + s12.square()
    mean, spread = 0.5 * (s11 + s22), squares.clamp_min(SMALLEST_SPREAD**2).sqrt()
    return mean - spread, mean + spread


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """min(|κ₁|, |κ₂|), one over unit length."""
    least, greatest = principal_curvatures(jet)
    return torch.minimum(least.abs(), greatest.abs())


SMALLER_CURVATURE = Term("smaller_curvature", residual, (NEAR,), TANGENT)

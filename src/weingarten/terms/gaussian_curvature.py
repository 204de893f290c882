"""Gaussian curvature: CAD's surfaces are piecewise developable (NeurCADRecon, Dong et al. 2024).

|K| = |S₁₁ S₂₂ − S₁₂²| = |det [[H, ∇f], [∇fᵀ, 0]]| / ‖∇f‖⁴, zero on planes, cylinders and cones. The
authors' code divides by ‖∇f‖² only, and that of arXiv 2511.08980 divides the tangent block's determinant by
‖∇f‖⁴ instead of ‖∇f‖², or not at all. Here the frame is a constant for the optimiser, as it is in the
off-diagonal Weingarten term.

Where faces meet in a tip a developable surface has curvature that it must keep: the double trough is
NeurCADRecon's polynomial which, beyond a first trough at 0, has a second one at |K| = π/2, where it is ¼. Of
untrained networks |K| is a hundred and more, and its fourth power would drown every other term; so beyond
the second trough the residual rises as |K| itself does.
"""

import math

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import TANGENT, Jet
from weingarten.scan.sample import NEAR, Sample
from weingarten.terms.term import Term

TROUGH = (
    3.0 / math.pi,
    (16.0 * math.pi - 29.0) / math.pi**2,
    -(64.0 * math.pi - 88.0) / math.pi**3,
    (64.0 * math.pi - 80.0) / math.pi**4,
)
"""Coefficients of |K|, |K|², |K|³, |K|⁴."""

SECOND = 0.5 * math.pi
"""The second trough, one over unit length squared."""


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|S₁₁ S₂₂ − S₁₂²|, one over unit length squared."""
    s11, s12, s22 = jet.shape_operator
    return (s11 * s22 - s12.square()).abs()


def double_trough(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """Σ TROUGH_i k^(i+1) + |K| − k, k = min(|K|, SECOND), K in one over unit length squared."""
    curvature = residual(jet, sample)
    linear, square, cube, fourth = TROUGH
    within = curvature.clamp(max=SECOND)
    return curvature - within + within * (linear + within * (square + within * (cube + within * fourth)))


GAUSSIAN_CURVATURE = Term("gaussian_curvature", residual, (NEAR,), TANGENT)
DOUBLE_TROUGH = Term("double_trough", double_trough, (NEAR,), TANGENT)

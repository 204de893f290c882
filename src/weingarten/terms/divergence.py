"""Divergence term: a field without sources away from the surface is smooth (DiGS, Ben-Shabat et al. 2022).

|∇·∇f| = |tr H|, zero on planes alone; on an exact distance it is |κ₁ + κ₂| of the level set. Points of the
whole box, as the authors have it. Their code clamps it to [0.1, 50], beyond which it has no gradient:
points where an untrained network is wild are left alone. Both are here.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import HESSIAN, Jet
from weingarten.scan.sample import OFF_SURFACE, Sample
from weingarten.terms.term import Term

LEAST, MOST = 0.1, 50.0
"""One over unit length."""


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|tr H|, one over unit length."""
    uu, _, vv, _, _, nn = jet.second
    return (uu + vv + nn).abs()


def clamped(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|tr H| within [LEAST, MOST]: the released code."""
    return residual(jet, sample).clamp(LEAST, MOST)


DIVERGENCE = Term("divergence", residual, (OFF_SURFACE,), HESSIAN)
DIVERGENCE_CLAMPED = Term("divergence", clamped, (OFF_SURFACE,), HESSIAN)

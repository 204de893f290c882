"""Normal divergence: along its gradient a distance does not bend (StEik, Yang et al. 2023).

|nᵀHn|, n = ∇f/‖∇f‖, is zero on all exact distances. It keeps the gradient flow of the eikonal term stable,
as the divergence does, but does not ask level sets to be flat. Points of the whole box, as the authors have
it. Here n is a constant for the optimiser; they let the gradient flow through it.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import HESSIAN, Jet
from weingarten.scan.sample import OFF_SURFACE, Sample
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|nᵀHn|, one over unit length."""
    return jet.second[-1].abs()


NORMAL_DIVERGENCE = Term("normal_divergence", residual, (OFF_SURFACE,), HESSIAN)

"""Eikonal term: the gradient of a distance has norm one (IGR eq. 2).

The paper's text has the squared form, its released code the absolute one, IGR the square of
that; all are here.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import GRADIENT, SMALLEST_NORM, Jet
from weingarten.scan.sample import NEAR, OFF_SURFACE, SURFACE, Sample
from weingarten.terms.term import Term


def squared(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """(‖∇f‖² − 1)², no unit: the paper's text."""
    return (jet.slope.square().sum(-1) - 1.0).square()


def absolute(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|‖∇f‖ − 1|, no unit: the released code."""
    return (jet.slope.square().sum(-1).clamp_min(SMALLEST_NORM**2).sqrt() - 1.0).abs()


def of_norm(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """(‖∇f‖ − 1)², no unit: IGR."""
    return absolute(jet, sample).square()


EIKONAL = Term("eikonal", squared, (SURFACE, NEAR), GRADIENT)
EIKONAL_ABSOLUTE = Term("eikonal", absolute, (SURFACE, NEAR), GRADIENT)
EIKONAL_OF_NORM = Term("eikonal", of_norm, (OFF_SURFACE, NEAR), GRADIENT)

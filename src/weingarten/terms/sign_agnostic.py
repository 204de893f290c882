"""Sign-agnostic regression: the field's absolute value is the distance to the cloud (SAL, Atzmon and Lipman
2020).

With τ(f, h) = | |f| − h |, h the distance to the nearest point, a network that begins as a sphere's
distance finds one sign inside and the other outside; from any other beginning it may as well find the
unsigned distance. Points of the whole box and near the surface. Between the points of a sparse cloud h is
too large.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import VALUE, Jet
from weingarten.scan.sample import NEAR, OFF_SURFACE, Sample
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """| |f| − h |, unit lengths; raises ValueError for points whose distance is not known."""
    if sample.unsigned is None:
        raise ValueError("sign-agnostic regression needs points that know their distance to the cloud")
    return (jet.value.abs() - sample.unsigned).abs()


SIGN_AGNOSTIC = Term("sign_agnostic", residual, (OFF_SURFACE, NEAR), VALUE)

"""On-surface term ("Dirichlet", DM): the field is zero on the cloud (method §2; SIREN eq. 6)."""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import VALUE, Jet
from weingarten.scan.sample import SURFACE, Sample
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|f|, unit lengths."""
    return jet.value.abs()


DIRICHLET = Term("dirichlet", residual, (SURFACE,), VALUE)

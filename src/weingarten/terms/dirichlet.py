"""On-surface term ("Dirichlet", DM): the field is zero on the cloud (SIREN eq. 6)."""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import VALUE, Jet
from weingarten.scan.sample import SURFACE, Sample
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """w |f|, unit lengths, with w the weight of the point: 1 unless the cloud is noisy."""
    error = jet.value.abs()
    return error if sample.weight is None else error * sample.weight


DIRICHLET = Term("dirichlet", residual, (SURFACE,), VALUE)

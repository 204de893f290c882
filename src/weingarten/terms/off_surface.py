"""Off-surface term (DNM): away from the cloud the field is not zero (SIREN eq. 6)."""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import VALUE, Jet
from weingarten.scan.sample import OFF_SURFACE, Sample
from weingarten.terms.term import Term

SHARPNESS = 100.0
"""α, one over unit length."""


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """exp(−α|f|), no unit."""
    return (-SHARPNESS * jet.value.abs()).exp()


OFF_SURFACE_TERM = Term("off_surface", residual, (OFF_SURFACE,), VALUE)

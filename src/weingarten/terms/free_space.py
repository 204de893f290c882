"""Free-space term: where empty space tells inside from outside, the field has that sign and distance.

Silent (zero, with zero gradient) where nothing is known.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import VALUE, Jet
from weingarten.scan.sample import OFF_SURFACE, Sample
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|f − d| where the signed distance d is known, else 0; unit lengths."""
    if sample.distance is None:
        return jet.value * 0.0
    known = ~sample.distance.isnan()
    return (jet.value - sample.distance.nan_to_num()).abs() * known


FREE_SPACE = Term("free_space", residual, (OFF_SURFACE,), VALUE)

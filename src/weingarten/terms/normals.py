"""Normal term: the gradient has the direction of the estimated normal, as far as that is to be trusted.

SIREN eq. 6 has the cosine of given normals; here they are estimated (`weingarten.scan.orientation`), and each
counts as much as it is long. Silent where none is known.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import GRADIENT, SMALLEST_NORM, Jet
from weingarten.scan.sample import SURFACE, Sample
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """‖m‖ − m·∇f / ‖∇f‖ with the outward normal m of length 0 to 1: ‖m‖ times one minus a cosine; no unit."""
    if sample.normals is None:
        return jet.value * 0.0
    norm = jet.slope.square().sum(-1).clamp_min(SMALLEST_NORM**2).sqrt()
    along = (sample.normals * jet.slope).sum(-1) / norm
    return sample.normals.norm(dim=-1) - along


NORMALS = Term("normals", residual, (SURFACE,), GRADIENT)

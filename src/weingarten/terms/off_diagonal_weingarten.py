"""Off-diagonal Weingarten term (ODW): no twist of the surface in a random tangent frame.

FlatCAD (arXiv 2506.16627) and its scheduled form (arXiv 2511.03147), method §2. Zero on planes and spheres;
on a cylinder of radius r its mean over frames is 1/(πr). Not to be confused with Gaussian curvature, which
is zero on cylinders and cones as well. The released code leaves the division by ‖∇f‖ out.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import TANGENT, Jet
from weingarten.scan.sample import NEAR, Sample
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|S₁₂| = |uᵀ H v| / ‖∇f‖, one over unit length."""
    return jet.shape_operator[1].abs()


OFF_DIAGONAL_WEINGARTEN = Term("off_diagonal_weingarten", residual, (NEAR,), TANGENT)

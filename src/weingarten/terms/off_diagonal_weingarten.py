"""Off-diagonal Weingarten term (ODW): no twist of the surface in a random tangent frame, or in any.

FlatCAD (arXiv 2506.16627) and its scheduled form (arXiv 2511.03147). Zero on planes and spheres;
on a cylinder of radius r its mean over frames is 1/(πr). Not to be confused with Gaussian curvature, which
is zero on cylinders and cones as well. The released code leaves the division by ‖∇f‖ out.

In a frame turned by φ from the principal directions S₁₂ = ½ (κ₂ − κ₁) sin 2φ. Its absolute mean over all
frames needs no random one and so has no variance: it is the second term here, new in this package.
"""

import math

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import TANGENT, Jet
from weingarten.scan.sample import NEAR, Sample
from weingarten.terms.principal_curvature import principal_curvatures
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|S₁₂| = |uᵀ H v| / ‖∇f‖, one over unit length."""
    return jet.shape_operator[1].abs()


def mean_over_frames(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|κ₁ − κ₂| / π = √((S₁₁ − S₂₂)² + 4 S₁₂²) / π, one over unit length."""
    least, greatest = principal_curvatures(jet)
    return (greatest - least) / math.pi


OFF_DIAGONAL_WEINGARTEN = Term("off_diagonal_weingarten", residual, (NEAR,), TANGENT)
FRAME_FREE_WEINGARTEN = Term("frame_free_weingarten", mean_over_frames, (NEAR,), TANGENT)

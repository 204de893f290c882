"""Singular Hessian: that of a distance has ∇f in its kernel (Wang et al. 2023).

|det H| is zero on all exact distances, whatever their shape, and so says nothing of curvature; multiplying
f by c multiplies it by |c|³. The finite-difference code of arXiv 2511.08980 takes the tangent block's
determinant under this name, which is Gaussian curvature: `weingarten.terms.gaussian_curvature` is that.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import HESSIAN, Jet
from weingarten.scan.sample import NEAR, Sample
from weingarten.terms.term import Term


def residual(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """|det H|, one over unit length cubed."""
    uu, uv, vv, un, vn, nn = jet.second
    return (uu * (vv * nn - vn * vn) - uv * (uv * nn - vn * un) + un * (uv * vn - vv * un)).abs()


SINGULAR_HESSIAN = Term("singular_hessian", residual, (NEAR,), HESSIAN)

"""Tangent blocks by central differences, for fields that are no MLP and for the FlatCAD-FD variants.

Yin & Musialski (FlatCAD, arXiv 2506.16627; arXiv 2511.08980), method §3:

    uv:  D± = (f(x ± h(u+v)) − f(x ± hu) − f(x ± hv) + f(x)) / h²,   uᵀHv ≈ ½ (D⁺ + D⁻)
    uu:  (f(x + hu) − 2 f(x) + f(x − hu)) / h²,   vv likewise

six evaluations beside the gradient; the error is of order h². The same six give uu and vv for nothing.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import TANGENT, Calculus, Jet, tangent_frame


class FiniteDifference:
    """Values and gradients from another calculus, tangent blocks from its values at distance h.

    step: h in unit lengths; the authors use 0.05, which is 40 % off on an untrained SIREN (method §3).
    """

    def __init__(self, inner: Calculus, step: float = 0.05) -> None:
        self.inner = inner
        self.step = step

    def __call__(
        self, points: Float[Tensor, "n *m 3"], order: int, angles: Float[Tensor, "n *m"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        if order < TANGENT:
            return self.inner(points, order)
        jet = self.inner(points, order - 1)
        u, v = tangent_frame(jet.slope, points.new_zeros(points.shape[:-1]) if angles is None else angles)
        h = self.step
        moves = torch.stack([u + v, u, v, -u - v, -u, -v]) * h
        f = jet.value
        shifted = self.inner((points + moves).flatten(0, 1), 0).value
        uv_plus, u_plus, v_plus, uv_minus, u_minus, v_minus = shifted.view(6, *f.shape)
        uu = (u_plus - 2 * f + u_minus) / h**2
        vv = (v_plus - 2 * f + v_minus) / h**2
        uv = 0.5 * (uv_plus - u_plus - v_plus + 2 * f + uv_minus - u_minus - v_minus) / h**2
        return Jet(f, jet.gradient, uu, uv, vv)

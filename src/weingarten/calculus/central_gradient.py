"""Gradients by central differences, for fields whose own are local, such as hash grids.

    ∂f/∂x_k ≈ (f(x + h e_k) − f(x − h e_k)) / 2h,   six evaluations; the error is of order h²

(Neuralangelo, Li et al. 2023, eq. 3). What trains a point then trains all cells that its stencil reaches, and
nothing has to be differentiated twice.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import GRADIENT, Calculus, Jet


class CentralGradient:
    """Values from another calculus, gradients from its values at distance h. step: h in unit lengths.

    There are no second derivatives here: `FiniteDifference` takes them from this as from any other.
    """

    def __init__(self, inner: Calculus, step: float) -> None:
        self.inner = inner
        self.step = step

    def __call__(
        self, points: Float[Tensor, "n *m 3"], order: int, angles: Float[Tensor, "n *m"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`; raises ValueError for an order above GRADIENT."""
        if order > GRADIENT:
            raise ValueError("central gradients have no second derivatives; wrap them in FiniteDifference")
        if order < GRADIENT:
            return self.inner(points, order)
        axes = self.step * torch.eye(3, dtype=points.dtype, device=points.device)
        moves = torch.cat([torch.zeros_like(axes[:1]), axes, -axes])
        shifted = points + moves.view(7, *(1,) * (points.dim() - 1), 3)
        value, *around = self.inner(shifted.flatten(0, 1), 0).value.view(7, *points.shape[:-1])
        forth, back = torch.stack(around[:3], dim=-1), torch.stack(around[3:], dim=-1)
        return Jet(value, (forth - back) / (2.0 * self.step))

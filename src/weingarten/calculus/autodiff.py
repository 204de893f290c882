"""Jets of any torch module by autograd's double backward: slow, general, and the reference for the rest."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.jet import GRADIENT, PAIRS, VALUE, Jet, directions


class Autodiff:
    """The calculus of any module f: (n, 3) → (n,), or (n, m, 3) → (n, m), that is twice differentiable.

    Differentiable with respect to the module's weights as often as the module allows.
    """

    def __init__(self, field: nn.Module) -> None:
        self.field = field

    def __call__(
        self, points: Float[Tensor, "n *m 3"], order: int, angles: Float[Tensor, "n *m"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        if order == VALUE:
            return Jet(self.field(points))
        x = points.detach().requires_grad_(True)
        with torch.enable_grad():
            value = self.field(x)
            gradient = differentiate(value, x)
            if order == GRADIENT:
                return Jet(value, gradient)
            turns = points.new_zeros(points.shape[:-1]) if angles is None else angles
            frame = directions(gradient, turns, order)
            products = [differentiate((gradient * direction).sum(-1), x) for direction in frame]
        pairs = [pair for pair in PAIRS if max(pair) < len(frame)]
        return Jet(value, gradient, *((products[i] * frame[j]).sum(-1) for i, j in pairs))


def differentiate(values: Float[Tensor, "n *m"], points: Float[Tensor, "n *m 3"]) -> Float[Tensor, "n *m 3"]:
    """∂ values_i / ∂ points_i, itself differentiable; zero where the values do not depend on the points."""
    if not values.requires_grad:
        return torch.zeros_like(points)
    (gradient,) = torch.autograd.grad(
        values.sum(), points, create_graph=True, allow_unused=True, materialize_grads=True
    )
    return gradient

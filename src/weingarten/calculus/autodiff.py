"""Jets of any torch module by autograd's double backward: slow, general, and the reference for the rest."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.jet import GRADIENT, VALUE, Jet, tangent_frame


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
            u, v = tangent_frame(gradient, points.new_zeros(points.shape[:-1]) if angles is None else angles)
            Hu = differentiate((gradient * u).sum(-1), x)
            Hv = differentiate((gradient * v).sum(-1), x)
        return Jet(value, gradient, (Hu * u).sum(-1), (Hu * v).sum(-1), (Hv * v).sum(-1))


def differentiate(values: Float[Tensor, "n *m"], points: Float[Tensor, "n *m 3"]) -> Float[Tensor, "n *m 3"]:
    """∂ values_i / ∂ points_i, itself differentiable; zero where the values do not depend on the points."""
    (gradient,) = torch.autograd.grad(
        values.sum(), points, create_graph=True, allow_unused=True, materialize_grads=True
    )
    return gradient

"""Exact jets of f = φ(g) from those of g, for fields with an outer function of one variable.

    ∇f = φ' ∇g,   aᵀH_f b = φ' aᵀH_g b + φ'' (a·∇g)(b·∇g)

With φ' > 0, g and f have one tangent frame. The products of u, v with ∇g are zero, but their derivatives with
respect to the weights are not, for the frame is a constant: so they are worked out.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import GRADIENT, PAIRS, VALUE, Calculus, Jet, directions
from weingarten.fields.sphered import Sphered


class Composed:
    """The calculus of a field with `outer`, given that of what is inside. As differentiable as that is."""

    def __init__(self, field: Sphered, inner: Calculus) -> None:
        self.field = field
        self.inner = inner

    def __call__(
        self, points: Float[Tensor, "n *m 3"], order: int, angles: Float[Tensor, "n *m"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        jet = self.inner(points, order, angles)
        outer = self.field.outer(jet.value)
        if order == VALUE:
            return Jet(outer.value)
        gradient = outer.first.unsqueeze(-1) * jet.slope
        if order == GRADIENT:
            return Jet(outer.value, gradient)
        turns = points.new_zeros(points.shape[:-1]) if angles is None else angles
        slopes = [(jet.slope * axis).sum(-1) for axis in directions(jet.slope, turns, order)]
        block = zip(PAIRS, jet.tensors[2:], strict=False)
        second = (outer.first * own + outer.second * slopes[a] * slopes[b] for (a, b), own in block)
        return Jet(outer.value, gradient, *second)

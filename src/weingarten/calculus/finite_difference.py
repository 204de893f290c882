"""Second derivatives by central differences, for fields that are no MLP and for the published FD variants.

Along a direction a, and across two of them, with f± = f(x ± h a) and so on:

    aᵀHa ≈ (f₊ − 2 f + f₋) / h²
    aᵀHb ≈ ½ (D⁺ + D⁻),   D± = (f(x ± h(a+b)) − f(x ± ha) − f(x ± hb) + f(x)) / h²          (DIAGONAL)
    aᵀHb ≈ (f(x + ha + hb) − f(x + ha − hb) − f(x − ha + hb) + f(x − ha − hb)) / 4h²        (CROSS)

DIAGONAL is FlatCAD's (arXiv 2506.16627; arXiv 2511.03147): six evaluations beside the gradient for the
tangent block, twelve for the whole Hessian. CROSS is that of arXiv 2511.08980: eight and eighteen. The error
of each is of order h². Method §3.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import PAIRS, TANGENT, Calculus, Jet, directions


@dataclass(frozen=True)
class Stencil:
    """Weights of a mixed derivative: h² aᵀHb ≈ Σ_c weight_c f(x + h(i_c a + j_c b)) + along s + centre f.

    s = f(x + ha) + f(x − ha) + f(x + hb) + f(x − hb). corners: (i, j, weight) of each.
    """

    corners: tuple[tuple[float, float, float], ...]
    along: float
    centre: float


DIAGONAL = Stencil(((1.0, 1.0, 0.5), (-1.0, -1.0, 0.5)), along=-0.5, centre=1.0)
CROSS = Stencil(
    ((1.0, 1.0, 0.25), (1.0, -1.0, -0.25), (-1.0, 1.0, -0.25), (-1.0, -1.0, 0.25)), along=0.0, centre=0.0
)


class FiniteDifference:
    """Values and gradients from another calculus, second derivatives from its values at distance h.

    step: h in unit lengths; the authors use 0.05, which is 40 % off on an untrained SIREN.
    """

    def __init__(self, inner: Calculus, step: float = 0.05, stencil: Stencil = DIAGONAL) -> None:
        self.inner = inner
        self.step = step
        self.stencil = stencil

    def __call__(
        self, points: Float[Tensor, "n *m 3"], order: int, angles: Float[Tensor, "n *m"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        if order < TANGENT:
            return self.inner(points, order)
        jet = self.inner(points, TANGENT - 1)
        turns = points.new_zeros(points.shape[:-1]) if angles is None else angles
        frame = directions(jet.slope, turns, order)
        pairs = [pair for pair in PAIRS if max(pair) < len(frame)]
        mixed = [pair for pair in pairs if pair[0] != pair[1]]
        values = self.around(points, frame, mixed)
        along = [values[2 * i] + values[2 * i + 1] for i in range(len(frame))]
        corners = dict(zip(mixed, values[2 * len(frame) :].split(len(self.stencil.corners)), strict=True))
        second = [
            along[i] - 2 * jet.value if i == j else self.across(jet.value, along[i] + along[j], corners[i, j])
            for i, j in pairs
        ]
        return Jet(jet.value, jet.gradient, *(total / self.step**2 for total in second))

    def around(
        self,
        points: Float[Tensor, "n *m 3"],
        frame: tuple[Float[Tensor, "n *m 3"], ...],
        mixed: list[tuple[int, int]],
    ) -> Float[Tensor, "k n *m"]:
        """f forth and back along every direction, then at the corners of every pair."""
        moves = [sign * direction for direction in frame for sign in (1.0, -1.0)]
        moves += [a * frame[i] + b * frame[j] for i, j in mixed for a, b, _ in self.stencil.corners]
        shifted = (points + self.step * torch.stack(moves)).flatten(0, 1)
        return self.inner(shifted, 0).value.view(len(moves), *points.shape[:-1])

    def across(
        self, centre: Float[Tensor, "n *m"], along: Float[Tensor, "n *m"], corners: Float[Tensor, "c n *m"]
    ) -> Float[Tensor, "n *m"]:
        """aᵀHb times h²."""
        weighed = sum(
            (weight * value for (_, _, weight), value in zip(self.stencil.corners, corners, strict=True)),
            self.stencil.along * along + self.stencil.centre * centre,
        )
        return weighed

"""SIREN: a multilayer perceptron with sine activations (Sitzmann et al. 2020, eq. 2–3).

f(x) = w·a_L + b,  a_l = sin(ω₀ (W_l a_{l−1} + b_l)),  a_0 = x.

The published codes call 3 → 256 → (256)×4 → 1 "four hidden layers": an input layer, four square ones and
a linear head, 264,449 weights.
"""

import math
from itertools import pairwise

import torch
from jaxtyping import Float
from torch import Tensor, nn


class Siren(nn.Module):
    """f: (n, 3) → (n,), sine layers and a linear head.

    width: units a layer. depth: sine layers (one from R³, depth − 1 square ones). frequency: ω₀.
    Initialised as in Sitzmann et al. 2020, §3.2 and supplement 1.5: first layer U(±1/3), the others
    U(±√(6/width)/ω₀), biases U(±1/√fan_in) as torch's linear layer has them.
    """

    def __init__(
        self,
        width: int = 256,
        depth: int = 5,
        frequency: float = 30.0,
        generator: torch.Generator | None = None,
    ) -> None:
        super().__init__()
        self.frequency = frequency
        sizes = [3, *[width] * depth, 1]
        self.weights = nn.ParameterList()
        self.biases = nn.ParameterList()
        for i, (fan_in, fan_out) in enumerate(pairwise(sizes)):
            bound = 1.0 / fan_in if i == 0 else math.sqrt(6.0 / fan_in) / frequency
            self.weights.append(nn.Parameter(uniform((fan_out, fan_in), bound, generator)))
            self.biases.append(nn.Parameter(uniform((fan_out,), 1.0 / math.sqrt(fan_in), generator)))

    @property
    def square_matrices(self) -> list[nn.Parameter]:
        """The square matrices between sine layers."""
        return list(self.weights)[1:-1]

    def refine(self, factor: float) -> None:
        """Shorten the waves that it begins with by a factor: ω₀ of the first layer alone."""
        with torch.no_grad():
            self.weights[0].mul_(factor)

    def forward(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """Field values at points of the unit frame."""
        a = points
        for weight, bias in zip(list(self.weights)[:-1], list(self.biases)[:-1], strict=True):
            a = torch.sin(self.frequency * torch.nn.functional.linear(a, weight, bias))
        return (a @ self.weights[-1].t() + self.biases[-1]).squeeze(-1)


def uniform(shape: tuple[int, ...], bound: float, generator: torch.Generator | None) -> Tensor:
    """Uniform draws in [−bound, bound]."""
    return torch.empty(shape).uniform_(-bound, bound, generator=generator)

"""The network of IGR: softplus layers with a skip connection, a sphere's distance at first.

    a_0 = x,   a_l = σ(W_l a_{l−1} + b_l),   σ(z) = log(1 + exp(βz)) / β,   f = w·a_L + b

and, where the skip enters, a_{l−1} is replaced by (a_{l−1}, x)/√2. Geometric initialisation (Atzmon and
Lipman 2020, theorem 1): W ~ N(0, 2/out), b = 0, w ~ N(√(π/n), 10⁻¹⁰), b = −r gives f ≈ ‖x‖ − r for wide
networks.
"""

import math

import torch
from jaxtyping import Float
from torch import Tensor, nn

SHARPNESS = 100.0
"""β: nearly a ramp, with second derivatives."""

SPREAD = 1e-5
"""Standard deviation of the head's weights."""


class SoftplusNet(nn.Module):
    """f: (n, 3) → (n,), ‖x‖ − radius at first.

    width: units a layer; the authors have 512. depth: softplus layers; theirs are 8. The input enters again
    halfway in a network of four layers or more. radius: unit lengths.
    """

    def __init__(
        self,
        width: int = 512,
        depth: int = 8,
        radius: float = 1.0,
        generator: torch.Generator | None = None,
    ) -> None:
        super().__init__()
        self.skip = depth // 2 if depth >= 4 else 0
        sizes = [(3 if layer == 0 else width, self.outputs(layer, width)) for layer in range(depth)]
        self.weights = nn.ParameterList(
            nn.Parameter(torch.randn(out, into, generator=generator) * math.sqrt(2.0 / out))
            for into, out in sizes
        )
        self.biases = nn.ParameterList(nn.Parameter(torch.zeros(out)) for _, out in sizes)
        head = math.sqrt(math.pi / width) + SPREAD * torch.randn(1, width, generator=generator)
        self.weights.append(nn.Parameter(head))
        self.biases.append(nn.Parameter(torch.full((1,), -radius)))

    def outputs(self, layer: int, width: int) -> int:
        """Units of a layer: with the input beside them, those before the skip are as wide as the others."""
        return width - 3 if self.skip and layer + 1 == self.skip else width

    @property
    def square_matrices(self) -> list[nn.Parameter]:
        """The square matrices between softplus layers."""
        return [weight for weight in self.weights if weight.shape[0] == weight.shape[1]]

    def forward(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """Field values at points of the unit frame."""
        a = points
        for layer, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            if self.skip and layer == self.skip:
                a = torch.cat([a, points], dim=-1) / math.sqrt(2.0)
            a = nn.functional.linear(a, weight, bias)
            if layer < len(self.weights) - 1:
                a = nn.functional.softplus(a, beta=SHARPNESS)
        return a.squeeze(-1)

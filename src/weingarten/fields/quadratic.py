"""StEik's network: sine layers of quadratic neurons (Yang et al. 2023, section 4).

    z = (A x + a) ∘ (B x + b) + C (x ∘ x) + c,   f = the head's z,   else sin ω₀z

With B and C nearly zero and b = 1 a quadratic layer is a linear one, A x + a, and so begins as any linear
network may.
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.fields.siren import Siren

SPREAD = 1e-5
"""Standard deviation of the first weights of B and C."""


class QuadraticLayer(nn.Module):
    """z of the formula above, from a linear layer's weight and bias as A and a."""

    def __init__(self, weight: Tensor, bias: Tensor, generator: torch.Generator | None) -> None:
        super().__init__()
        self.A, self.a = (nn.Parameter(one.detach().clone()) for one in (weight, bias))
        self.B, self.C = (
            nn.Parameter(SPREAD * torch.randn(weight.shape, generator=generator)) for _ in range(2)
        )
        self.b, self.c = nn.Parameter(torch.ones_like(bias)), nn.Parameter(torch.zeros_like(bias))

    def forward(self, x: Float[Tensor, "n inputs"]) -> Float[Tensor, "n outputs"]:
        """z."""
        linear = nn.functional.linear
        return linear(x, self.A, self.a) * linear(x, self.B, self.b) + linear(x * x, self.C, self.c)


class QuadraticSiren(nn.Module):
    """f: (n, 3) → (n,), which begins as the SIREN that it is made of; three times its weights."""

    def __init__(self, siren: Siren, generator: torch.Generator | None = None) -> None:
        super().__init__()
        self.frequency = siren.frequency
        pairs = zip(siren.weights, siren.biases, strict=True)
        self.layers = nn.ModuleList(QuadraticLayer(weight, bias, generator) for weight, bias in pairs)

    @property
    def square_matrices(self) -> list[nn.Parameter]:
        """The square matrices A between sine layers. B and C, next to zero, are no such matrices: steps of
        Muon, as long as A's, would be all there is of them.
        """
        matrices = [layer.A for layer in list(self.layers)[1:-1]]
        return [matrix for matrix in matrices if isinstance(matrix, nn.Parameter)]

    def forward(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """Field values at points of the unit frame."""
        a = points
        for layer in list(self.layers)[:-1]:
            a = torch.sin(self.frequency * layer(a))
        return self.layers[-1](a).squeeze(-1)

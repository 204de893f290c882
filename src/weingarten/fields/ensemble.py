"""Many SIRENs of one size as one module: every layer one batched product instead of a small one for each.

    f_i(x) = w_i·a_L + b_i,   a_l = sin(ω₀ (W_l,i a_{l−1} + b_l,i)),   i = 1 … m

Members share nothing but the operations that evaluate them. It is not an ensemble in the sense of statistics:
nobody takes their mean.
"""

from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.fields.siren import Siren


class Ensemble(nn.Module):
    """f: (n, m, 3) → (n, m): row k holds the k-th point of each of m parts, column i belongs to member i.

    weights: (m, out, in), biases: (m, out), by layer, as a SIREN has them without the m; frequency: ω₀.
    """

    def __init__(
        self,
        weights: Sequence[Float[Tensor, "m _out _in"]],
        biases: Sequence[Float[Tensor, "m _out"]],
        frequency: float,
    ) -> None:
        super().__init__()
        self.weights = nn.ParameterList(nn.Parameter(weight) for weight in weights)
        self.biases = nn.ParameterList(nn.Parameter(bias) for bias in biases)
        self.frequency = frequency

    @classmethod
    def of(cls, members: Sequence[Siren]) -> "Ensemble":
        """The members' weights, copied side by side. Raises ValueError unless all are of one size and ω₀."""
        shapes = {(one.frequency, *(tuple(weight.shape) for weight in one.weights)) for one in members}
        if len(shapes) != 1:
            raise ValueError(f"an ensemble needs members, all of one width, depth, frequency; got {shapes}")
        with torch.no_grad():
            weights = [torch.stack(layer) for layer in zip(*(one.weights for one in members), strict=True)]
            biases = [torch.stack(layer) for layer in zip(*(one.biases for one in members), strict=True)]
        return cls(weights, biases, members[0].frequency)

    def __len__(self) -> int:
        return len(self.weights[0])

    def member(self, index: int) -> Siren:
        """A SIREN with a copy of one member's weights."""
        width, depth = self.weights[-1].shape[-1], len(self.weights) - 1
        with torch.device("meta"):
            siren = Siren(width, depth, self.frequency)
        own = {name: value[index].clone() for name, value in self.state_dict().items()}
        siren.load_state_dict(own, assign=True)
        return siren

    @property
    def square_matrices(self) -> list[nn.Parameter]:
        """The square matrices between sine layers, m in each."""
        return list(self.weights)[1:-1]

    def forward(self, points: Float[Tensor, "n m 3"]) -> Float[Tensor, "n m"]:
        """Field values at points of each member's unit frame."""
        a = points.transpose(0, 1)
        for weight, bias in zip(list(self.weights)[:-1], list(self.biases)[:-1], strict=True):
            a = torch.sin(self.frequency * torch.baddbmm(bias.unsqueeze(-2), a, weight.mT))
        return torch.baddbmm(self.biases[-1].unsqueeze(-2), a, self.weights[-1].mT).squeeze(-1).t()


def members(field: nn.Module) -> tuple[int, ...]:
    """What an ensemble adds to the shape of everything that each part has: (m,); for any other field ()."""
    return (len(field),) if isinstance(field, Ensemble) else ()

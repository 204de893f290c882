"""A field as the extraction wants it: positions on the CPU in, values on the CPU out, no graph kept."""

from collections.abc import Callable

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.jet import VALUE
from weingarten.methods import exact


def field_values(module: nn.Module) -> Callable[[Float[Tensor, "n 3"]], Float[Tensor, " n"]]:
    """The values of a network, wherever it lives, by its fastest calculus."""
    calculus = exact(module)
    device = next(module.parameters()).device

    def values(points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        with torch.no_grad():
            return calculus(points.to(device), VALUE).value.cpu()

    return values

"""A field as the extraction wants it: positions on the CPU in, values on the CPU out, no graph kept."""

from collections.abc import Callable

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.jet import VALUE
from weingarten.crew import Crew
from weingarten.methods import exact

PIECE, GPU_PIECE = 8192, 1 << 18
"""Points that are evaluated together: few enough that every core gets some."""


def field_values(module: nn.Module, crew: Crew) -> Callable[[Float[Tensor, "n 3"]], Float[Tensor, " n"]]:
    """The values of a network, wherever it lives, by its fastest calculus; a piece of the points a core."""
    calculus = exact(module)
    device = next(module.parameters()).device
    size = PIECE if device.type == "cpu" else GPU_PIECE

    def piece_values(points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        return calculus(points.to(device), VALUE).value.cpu()

    def values(points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        with torch.no_grad(), crew:
            return torch.cat(crew.map(piece_values, points.split(size)))

    return values

"""A field as the extraction wants it: positions in, values on the field's device out, no graph kept."""

from collections.abc import Callable

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.choice import exact
from weingarten.calculus.jet import VALUE
from weingarten.crew import Crew

PIECE = 8192
"""Points that a core evaluates together: few enough that every core gets some."""

BATCH = 1 << 18
"""Points that another device evaluates together, and so the most that it pays to ask for at once."""


def field_values(module: nn.Module, crew: Crew) -> Callable[[Float[Tensor, "n 3"]], Float[Tensor, " n"]]:
    """The values of a network, wherever it lives, by its fastest calculus; a piece of the points a core."""
    calculus = exact(module)
    device = next(module.parameters()).device
    size = PIECE if device.type == "cpu" else BATCH

    def piece_values(points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        return calculus(points.to(device), VALUE).value

    def values(points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        with torch.no_grad(), crew:
            return torch.cat(crew.map(piece_values, points.split(size)))

    return values

"""How a field's weights move: optimisers by name, and the learning rate as a function of the step."""

import math
from collections.abc import Callable
from typing import Protocol, runtime_checkable

from torch import nn

from weingarten.fit.adam import Adam
from weingarten.fit.muon import Muon
from weingarten.fit.optimiser import Optimiser

Rate = Callable[[int, int], float]


@runtime_checkable
class Layered(Protocol):
    """A field that names the square matrices between its layers; a name that no one else's module has."""

    @property
    def square_matrices(self) -> list[nn.Parameter]:
        """These."""
        ...


def adam(field: nn.Module) -> list[Optimiser]:
    """Adam for every weight."""
    return [Adam(field.parameters())]


def muon(field: nn.Module) -> list[Optimiser]:
    """Muon for a field's square matrices, Adam at the same rate for all else.

    Fields that name no square matrices are moved by Adam alone.
    """
    square = field.square_matrices if isinstance(field, Layered) else []
    names = {id(weight) for weight in square}
    rest = [weight for weight in field.parameters() if id(weight) not in names]
    return [Muon(square), Adam(rest)] if square else [Adam(rest)]


OPTIMISERS: dict[str, Callable[[nn.Module], list[Optimiser]]] = {"adam": adam, "muon": muon}


def steady(step: int, steps: int) -> float:
    """1: the rate never changes."""
    return 1.0


def cosine(step: int, steps: int) -> float:
    """Up linearly over 50 steps (at most a sixth of all), then a half cosine down to 2 %."""
    warm = max(1, min(50, steps // 6))
    if step < warm:
        return (step + 1) / warm
    t = (step - warm) / max(1, steps - warm)
    return 0.02 + 0.98 * 0.5 * (1.0 + math.cos(math.pi * t))


RATES: dict[str, Rate] = {"steady": steady, "cosine": cosine}

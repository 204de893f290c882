"""How a field's weights move: optimisers by name, and the learning rate as a function of the step.

Each builder returns ordinary torch optimisers, so that their state is torch's own.
"""

import math
from collections.abc import Callable

import torch
from torch import nn

from weingarten.fields.siren import Siren

Rate = Callable[[int, int], float]


def adam(field: nn.Module, rate: float) -> list[torch.optim.Optimizer]:
    """Adam for every weight, torch's defaults (method §2)."""
    return [torch.optim.Adam(field.parameters(), lr=rate)]


def muon(field: nn.Module, rate: float) -> list[torch.optim.Optimizer]:
    """Muon for the square matrices of a SIREN, Adam at the same rate for all else (findings).

    An update of Muon is scaled by 0.2 √max(rows, columns), which gives it the size of Adam's.
    Fields that name no hidden matrices are moved by Adam alone.
    """
    hidden = field.hidden if isinstance(field, Siren) else []
    names = {id(weight) for weight in hidden}
    rest = [weight for weight in field.parameters() if id(weight) not in names]
    optimisers: list[torch.optim.Optimizer] = [torch.optim.Adam(rest, lr=rate)]
    if hidden:
        optimisers.append(
            torch.optim.Muon(
                hidden,
                lr=rate,
                weight_decay=0.0,
                momentum=0.95,
                nesterov=True,
                adjust_lr_fn="match_rms_adamw",
            )
        )
    return optimisers


OPTIMISERS: dict[str, Callable[[nn.Module, float], list[torch.optim.Optimizer]]] = {
    "adam": adam,
    "muon": muon,
}


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

"""What an adaptive weight is told after every step: losses, weights and, now and then, gradients."""

from collections.abc import Mapping
from dataclasses import dataclass

LARGEST = 1e100
"""No mean residual or norm beyond this is believed; sums of what is believed stay finite."""


@dataclass(frozen=True)
class Seen:
    """What a step saw.

    progress: t ∈ [0, 1]. losses: mean residual by term name, NaN where not evaluated. weights: by term name,
    as they were at that step. gradients: ‖∇_W L_i‖ of the unweighted mean loss by term name, None when not
    asked for.
    """

    progress: float
    losses: Mapping[str, float]
    weights: Mapping[str, float]
    gradients: Mapping[str, float] | None = None


def sound(value: float) -> bool:
    """Whether a mean residual or a norm can be reckoned with: neither NaN nor negative nor infinite."""
    return 0.0 <= value <= LARGEST

"""Weights from the losses' slopes: Heydari, Thompson & Mehmood, "SoftAdapt: Techniques for adaptive loss
weighting of neural networks with multi-part loss functions", 2019 (arXiv 1912.12355).
"""

import math
from collections.abc import Mapping
from typing import Any

from weingarten.schedules.balance import mean, softmax

SHARPNESS = 1.0
"""β: normalised slopes lie within ±1, so two weights differ by a factor of at most e."""

BLOCK = 25
"""Steps that make up what the source calls an epoch."""


class SoftAdapt:
    """SoftAdapt with normalised slopes. A Balancer.

        s_i = mean of ℓ_i over the last block − mean over the one before
        b_i = m exp(β s_i / Σ|s_j|) / Σ_k exp(β s_k / Σ|s_j|)

    Its other variants leave out the division, or multiply exp(·) by the loss. A loss that falls more slowly
    than the others, or rises, gets more weight (β > 0). For the scheduled term alone: λ = λ₀ while all fall
    alike. Scaling all weights of the fit changes nothing; λ₀ does not cancel, for it sets how much of the
    whole slope is the curvature's.

    Where we differ: the source takes its slopes between epochs, and we know only minibatches, whose noise is
    far greater than the slope from one to the next; so a block of them stands for an epoch, and its mean for
    the epoch's loss. The difference is of first order, since higher ones would amplify that noise. The
    authors' code divides by the sum of the slopes with their signs, which may vanish and turn the rule round.
    Their β = 0.1 belongs to slopes that are not normalised.
    """

    gradients_every = 0

    def __init__(self, sharpness: float = SHARPNESS, block: int = BLOCK) -> None:
        self.sharpness, self.length = sharpness, block
        self.block: list[dict[str, float]] = []
        self.before: dict[str, float] = {}
        self.own: dict[str, float] = {}

    def weights(self) -> dict[str, float]:
        """b, whose mean is 1."""
        return dict(self.own)

    def step(self, losses: Mapping[str, float], gradients: Mapping[str, float] | None) -> None:
        """Take in the losses; at the end of a block, weigh anew."""
        self.block.append(dict(losses))
        if len(self.block) < self.length:
            return
        means = {name: mean(row[name] for row in self.block if name in row) for name in losses}
        slopes = {name: value - self.before.get(name, value) for name, value in means.items()}
        whole = math.fsum(abs(slope) for slope in slopes.values()) or 1.0
        self.own = softmax({name: self.sharpness * slope / whole for name, slope in slopes.items()})
        self.before, self.block = means, []

    def state(self) -> dict[str, Any]:
        """The running block, the means of the one before, and the weights."""
        return {
            "block": [dict(row) for row in self.block],
            "before": dict(self.before),
            "own": dict(self.own),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`."""
        self.block = [dict(row) for row in state["block"]]
        self.before, self.own = dict(state["before"]), dict(state["own"])

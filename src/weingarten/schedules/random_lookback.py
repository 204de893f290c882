"""Weights from relative progress: Bischof & Kraus, "Multi-objective loss balancing for physics-informed deep
learning", 2021 (arXiv 2110.09813), ReLoBRaLo.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from weingarten.schedules.balance import firsts, quotients, softmax

TEMPERATURE = 1.0
"""The lower, the more a loss gets that lags behind; towards infinity all get the same."""

MEMORY = 0.99
"""α: weights remember 100 steps. The source's 0.999 is for some 10⁵ of them."""

KEPT = 0.99
"""E[ρ]: a look back to the first losses about every 100 steps."""


class RandomLookback:
    """Relative loss balancing with random lookback. A Balancer.

        bal_i(t, t') = m exp(ℓ_i(t) / (T ℓ_i(t'))) / Σ_j exp(ℓ_j(t) / (T ℓ_j(t')))
        hist_i(t)    = ρ b_i(t − 1) + (1 − ρ) bal_i(t, 0),      ρ ∈ {0, 1} drawn with mean E[ρ]
        b_i(t)       = α hist_i(t) + (1 − α) bal_i(t, t − 1)

    What has fallen least, since the step before and now and then since the first, gets most. For the
    scheduled term alone: λ = λ₀ while all fall alike; else, at T = 1, between λ₀/e and e λ₀ as long as no
    loss rises. Only quotients of a loss with itself enter, so no weight of the fit changes anything but by
    its own share: λ is in proportion to λ₀.

    The draws come from a generator of its own, whose state is part of `state`. ℓ_i(0) is the first loss that
    is not zero.
    """

    gradients_every = 0

    def __init__(
        self, seed: int, temperature: float = TEMPERATURE, memory: float = MEMORY, kept: float = KEPT
    ) -> None:
        self.temperature, self.memory, self.kept = temperature, memory, kept
        self.generator = np.random.Generator(np.random.PCG64(seed))
        self.first: dict[str, float] = {}
        self.before: dict[str, float] = {}
        self.own: dict[str, float] = {}

    def weights(self) -> dict[str, float]:
        """b."""
        return dict(self.own)

    def step(self, losses: Mapping[str, float], gradients: Mapping[str, float] | None) -> None:
        """Take in the losses; one draw."""
        self.first = firsts(self.first, losses)
        recent, whole = self.balanced(losses, self.before), self.balanced(losses, self.first)
        keep = self.generator.random() < self.kept
        for name in losses:
            history = self.own.get(name, 1.0) if keep else whole[name]
            self.own[name] = self.memory * history + (1.0 - self.memory) * recent[name]
        self.before = dict(losses)

    def balanced(self, losses: Mapping[str, float], earlier: Mapping[str, float]) -> dict[str, float]:
        """bal(t, t')."""
        ratios = quotients(losses, earlier)
        return softmax({name: ratio / self.temperature for name, ratio in ratios.items()})

    def state(self) -> dict[str, Any]:
        """Losses to compare with, weights, and the generator's state."""
        return {
            "first": dict(self.first),
            "before": dict(self.before),
            "own": dict(self.own),
            "generator": self.generator.bit_generator.state,
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`."""
        self.first, self.before = dict(state["first"]), dict(state["before"])
        self.own = dict(state["own"])
        self.generator.bit_generator.state = state["generator"]

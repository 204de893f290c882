"""Weights from the uncertainty of each loss: Kendall, Gal & Cipolla, "Multi-task learning using uncertainty
to weigh losses for scene geometry and semantics", CVPR 2018 (arXiv 1705.07115).
"""

import math
from collections.abc import Mapping
from typing import Any

RATE = 0.1
"""Of the descent: near its minimum s forgets in 2/RATE = 20 steps, as far as minibatches need averaging."""

RANGE = (-45.0, 70.0)
"""Of s: losses from 10⁻²⁰ to 10³⁰."""


class Uncertainty:
    """Homoscedastic uncertainty weighting. A Balancer.

        minimise ½ Σ (exp(−s_i) L_i + s_i),   s_i = log σ_i²        (eq. 7 with s for log σ²)

    The derivative by s_i is ½ (1 − exp(−s_i) L_i): it needs the loss and nothing of the network, and it
    vanishes at s_i = log L_i. So the s_i take descent steps of their own beside the fit's. The weights are
    exp(−s_i), that is 1/L_i where the losses stand still: every weighted loss is then the same. (The ½ is
    before the logarithm's part as well, so it moves no minimum; residuals |·|, whose likelihood is Laplace's
    and has no ½, have the same one.)

    For the scheduled term alone: λ₀ cancels, and λ L tends to the harmonic mean of the others' w_i L_i.
    It balances and does not decay: λ rises as L falls.

    Where we differ: s_i starts at its minimum for the first loss instead of at a constant, so that weights
    of 7000 and of 1 need no time to be told apart; its derivative is clipped to ±½, what it is at most where
    the loss falls, so that a single absurd loss cannot throw it.
    """

    gradients_every = 0

    def __init__(self, rate: float = RATE) -> None:
        self.rate = rate
        self.s: dict[str, float] = {}

    def weights(self) -> dict[str, float]:
        """exp(−s_i)."""
        return {name: math.exp(-s) for name, s in self.s.items()}

    def step(self, losses: Mapping[str, float], gradients: Mapping[str, float] | None) -> None:
        """One step of descent of every s."""
        self.s = {name: self.moved(self.s.get(name), loss) for name, loss in losses.items()}

    def moved(self, s: float | None, loss: float) -> float:
        """s after a step, or where it starts."""
        if s is None:
            return within_range(math.log(loss)) if loss > 0.0 else 0.0
        derivative = 0.5 * (1.0 - math.exp(-s) * loss)
        return within_range(s - self.rate * max(-0.5, min(derivative, 0.5)))

    def state(self) -> dict[str, Any]:
        """Every s."""
        return {"s": dict(self.s)}

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`."""
        self.s = dict(state["s"])


def within_range(s: float) -> float:
    """s within RANGE."""
    return max(RANGE[0], min(s, RANGE[1]))

"""Weights that level the gradients: Chen, Badrinarayanan, Lee & Rabinovich, "GradNorm: Gradient normalization
for adaptive loss balancing in deep multitask networks", ICML 2018 (arXiv 1711.02257).
"""

import math
from collections.abc import Mapping
from typing import Any

from weingarten.schedules.balance import firsts, mean, quotients

ASYMMETRY = 0.12
"""The source's exponent for tasks that are much alike; for unlike ones it takes 1.5 and tries up to 3. A
curvature term that cannot fall to zero (1/(πr) on a cylinder) would be driven on and on by a large one."""

RATE = 0.2
"""Of the descent, in the logarithm of a weight: halfway in about four gradients."""

EVERY = 10
"""Steps from one gradient to the next. Each costs a backward pass for every term."""

LEAST = 1e-6
"""Of a weight before all are scaled to their sum."""


class GradientNorm:
    """GradNorm. A Balancer.

        G_i = ‖∇_W (b_i ℓ_i)‖,   r_i = (ℓ_i / ℓ_i(0)) / mean of ℓ_j / ℓ_j(0)
        minimise Σ |G_i − mean(G) · r_i^a| over b, the target held fixed     (eq. 1, 2)
        scale b so that Σ b_i = m                                            (algorithm 1)

    A loss that has fallen less than the others shall have the greater gradient. For the scheduled term
    alone, with a = 0: λ₀ cancels, and λ ‖∇L‖ tends to the harmonic mean of the others' w_i ‖∇L_i‖.

    Where we differ, the descent: the derivative by log b_i has the sign of log(G_i / (mean(G) r_i^a)), and we
    step against that logarithm, clipped to ±1, instead of against the sign times G_i. The direction is a
    descent of the source's sum all the same; but the step does not depend on the unit of a gradient, dies out
    at the target instead of swinging about it, and no weight can become negative. It stands still, once
    scaled, where G_i ∝ r_i^a. ℓ_i(0) is the first loss that is not zero. W: whatever weights the caller takes
    the norm over, the last shared layer in the source.
    """

    def __init__(self, asymmetry: float = ASYMMETRY, rate: float = RATE, every: int = EVERY) -> None:
        self.asymmetry, self.rate, self.gradients_every = asymmetry, rate, every
        self.first: dict[str, float] = {}
        self.own: dict[str, float] = {}

    def weights(self) -> dict[str, float]:
        """b."""
        return dict(self.own)

    def step(self, losses: Mapping[str, float], gradients: Mapping[str, float] | None) -> None:
        """Take in the losses; where there are gradients, one step of descent and the scaling."""
        self.first = firsts(self.first, losses)
        known = {name: norm for name, norm in (gradients or {}).items() if name in losses}
        if not known:
            return
        own = {name: self.own.get(name, 1.0) for name in known}
        norms = {name: own[name] * norm for name, norm in known.items()}
        for name, target in self.targets({name: losses[name] for name in known}, norms).items():
            own[name] = max(LEAST, own[name] * math.exp(-self.rate * excess(norms[name], target)))
        average = mean(own.values())
        self.own = {name: weight / average for name, weight in own.items()}

    def targets(self, losses: Mapping[str, float], norms: Mapping[str, float]) -> dict[str, float]:
        """mean(G) · r_i^a."""
        ratios = quotients(losses, self.first)
        average, level = mean(ratios.values()), mean(norms.values())
        rates = {name: ratio / average if average > 0.0 else 1.0 for name, ratio in ratios.items()}
        return {name: level * rate**self.asymmetry for name, rate in rates.items()}

    def state(self) -> dict[str, Any]:
        """First losses and weights."""
        return {"first": dict(self.first), "own": dict(self.own)}

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`."""
        self.first, self.own = dict(state["first"]), dict(state["own"])


def excess(norm: float, target: float) -> float:
    """log(norm / target) within ±1; 0 where both are zero."""
    if norm <= 0.0 or target <= 0.0:
        return float(norm > 0.0) - float(target > 0.0)
    return max(-1.0, min(math.log(norm) - math.log(target), 1.0))

"""Weights that put what is hardest first: Guo, Haque, Huang, Yeung & Fei-Fei, "Dynamic task prioritization
for multitask learning", ECCV 2018.
"""

import math
from collections.abc import Mapping
from typing import Any

from weingarten.schedules.balance import firsts, quotients

FOCUS = 1.0
"""γ: the greater, the less a task gets that is nearly done."""

DISCOUNT = 0.05
"""Share of the newest indicator in the running mean: it remembers 20 steps."""

EASE = (0.05, 0.99)
"""The indicator stays within: at 0 the weight would be infinite, at 1 it would be none."""


class TaskPriority:
    """Dynamic task prioritisation. A Balancer.

        κ̄_i ← α κ_i + (1 − α) κ̄_i
        b_i = −(1 − κ̄_i)^γ log κ̄_i          (the focal loss, of tasks instead of examples)

    κ_i ∈ (0, 1] says how well task i is done. The source takes the task's own score, accuracy or precision;
    a residual has none, so here it is the share of the first loss that is gone, κ_i = 1 − ℓ_i / ℓ_i(0),
    within EASE. A task that has not moved has the greatest weight, 2.8, one that is done next to none.

    For the scheduled term alone: as long as all progress alike, λ = λ₀; where the curvature falls faster
    than the rest, less. λ₀ does not cancel. The source multiplies each b_i by a loss that is itself focal;
    ours are means of residuals.
    """

    gradients_every = 0

    def __init__(self, focus: float = FOCUS, discount: float = DISCOUNT) -> None:
        self.focus, self.discount = focus, discount
        self.first: dict[str, float] = {}
        self.progress: dict[str, float] = {}

    def weights(self) -> dict[str, float]:
        """−(1 − κ̄)^γ log κ̄."""
        return {name: -((1.0 - k) ** self.focus) * math.log(k) for name, k in self.progress.items()}

    def step(self, losses: Mapping[str, float], gradients: Mapping[str, float] | None) -> None:
        """Take in the losses."""
        self.first = firsts(self.first, losses)
        for name, left in quotients(losses, self.first).items():
            now = max(EASE[0], min(1.0 - left, EASE[1]))
            before = self.progress.get(name, now)
            self.progress[name] = self.discount * now + (1.0 - self.discount) * before

    def state(self) -> dict[str, Any]:
        """First losses and running means."""
        return {"first": dict(self.first), "progress": dict(self.progress)}

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`."""
        self.first, self.progress = dict(state["first"]), dict(state["progress"])

"""From a rule's ratio to the weight of a step: smoothing, and an envelope that bounds it."""

import math
from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

from weingarten.schedules.schedule import Schedule
from weingarten.schedules.seen import Seen

SMOOTHING = 0.02
"""Memory of the moving average, as a share of the fit: 13 steps of 650, 200 of 10,000."""


@runtime_checkable
class Ratio(Protocol):
    """What a rule says of the scheduled term: how many times its reference weight it should have.

    One fit's; mutable. Before anything was watched it is 1.
    gradients_every: 0 where it never needs gradients; k where it wants them at every k-th step.
    """

    @property
    def gradients_every(self) -> int: ...

    def ratio(self) -> float:
        """Finite, not negative."""
        ...

    def watch(self, seen: Seen) -> None:
        """Take in one step."""
        ...

    def state(self) -> dict[str, Any]:
        """All that it remembers, as plain JSON values."""
        ...

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`, to the bit."""
        ...


class Bounded:
    """The weight λ that a ratio ρ makes of an envelope's greatest weight λ₀, never above the envelope.

        w ← w + (1 − exp(−Δt / smoothing)) (λ₀ min(ρ, 1) − w),   w = λ₀ at first
        λ(t) = min(w, envelope(t))

    The average runs over progress, not over steps, so that a fit of few steps and one of many are steered
    alike. What it averages is bounded first: one absurd loss moves the weight no further than any other.
    The envelope limits and does not multiply: where it leaves room, the weight is the rule's own.
    """

    def __init__(self, rule: Ratio, envelope: Schedule, smoothing: float = SMOOTHING) -> None:
        self.rule, self.envelope, self.smoothing = rule, envelope, smoothing
        self.weight = envelope.greatest
        self.progress: float | None = None

    @property
    def gradients_every(self) -> int:
        """The rule's."""
        return self.rule.gradients_every

    def __call__(self, t: float) -> float:
        """The weight for the step at progress t, given what was watched so far."""
        return min(self.weight, self.envelope(t))

    def watch(self, seen: Seen) -> None:
        """Take in one step."""
        self.rule.watch(seen)
        passed = 0.0 if self.progress is None else max(0.0, seen.progress - self.progress)
        self.progress = seen.progress
        wanted = self.envelope.greatest * min(self.rule.ratio(), 1.0)
        self.weight += (1.0 - math.exp(-passed / self.smoothing)) * (wanted - self.weight)

    def state(self) -> dict[str, Any]:
        """All that it and its rule remember, as plain JSON values."""
        return {"weight": self.weight, "progress": self.progress, "rule": self.rule.state()}

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`, to the bit."""
        self.weight, self.progress = state["weight"], state["progress"]
        self.rule.restore(state["rule"])

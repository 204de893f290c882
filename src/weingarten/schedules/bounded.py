"""From a rule's ratio to the weight of a step: a reference, smoothing, a bound and an envelope."""

import math
from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

from weingarten.schedules.schedule import Schedule
from weingarten.schedules.seen import Seen

BOUND = 10.0
"""The greatest weight unless told otherwise (method §4)."""

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
    """The weight λ that a ratio ρ makes of a reference λ₀, within [0, bound] and never above an envelope.

        w ← w + (1 − exp(−Δt / smoothing)) (min(λ₀ρ, bound) − w),   w = λ₀ at first
        λ(t) = min(w, envelope(t))

    The average runs over progress, not over steps, so that a fit of few steps and one of many are steered
    alike. What it averages is bounded first: one absurd loss moves the weight no further than any other.
    The envelope limits and does not multiply: where it leaves room, the weight is the rule's own.
    """

    def __init__(
        self,
        rule: Ratio,
        reference: float,
        envelope: Schedule,
        bound: float = BOUND,
        smoothing: float = SMOOTHING,
    ) -> None:
        self.rule, self.envelope, self.bound, self.smoothing = rule, envelope, bound, smoothing
        self.reference = min(reference, bound)
        self.weight = self.reference
        self.progress: float | None = None

    @property
    def gradients_every(self) -> int:
        """The rule's."""
        return self.rule.gradients_every

    def __call__(self, t: float) -> float:
        """The weight for the step at progress t, given what was watched so far."""
        return min(self.weight, self.envelope(t), self.bound)

    def watch(self, seen: Seen) -> None:
        """Take in one step."""
        self.rule.watch(seen)
        passed = 0.0 if self.progress is None else max(0.0, seen.progress - self.progress)
        self.progress = seen.progress
        wanted = min(self.reference * self.rule.ratio(), self.bound)
        self.weight += (1.0 - math.exp(-passed / self.smoothing)) * (wanted - self.weight)

    def state(self) -> dict[str, Any]:
        """All that it and its rule remember, as plain JSON values."""
        return {"weight": self.weight, "progress": self.progress, "rule": self.rule.state()}

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`, to the bit."""
        self.weight, self.progress = state["weight"], state["progress"]
        self.rule.restore(state["rule"])

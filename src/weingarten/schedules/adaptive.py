"""Weights of one scheduled term that watch the losses of the fit, and never the ground truth.

Beside the pure schedules, which are functions of progress alone. Method §4 says which and why; the rules are
in files of their own. All but `discrepancy` balance losses that are minimised together; how their say is
turned into one weight is in `balance.py`, what is done to it then in `bounded.py`.

| rule | watches | λ = λ₀ as long as | lowers λ where |
|---|---|---|---|
| kendall | losses | λ₀L is the harmonic mean of the others' w_i L_i | L is greater than that |
| gradnorm | gradients, losses | the same of their gradients | the gradient is too great, L falls fast |
| dtp | losses over first losses | all progress alike | L falls faster than the rest |
| softadapt | slopes of the losses | all slopes are alike | the same |
| relobralo | losses over earlier ones | all progress alike | the same |
| discrepancy | the data residual | that can get below the noise | it cannot |
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from weingarten.schedules.balance import Balance, Balancer
from weingarten.schedules.bounded import SMOOTHING, Bounded, Ratio
from weingarten.schedules.discrepancy import SMOOTHING as STEADY
from weingarten.schedules.discrepancy import Discrepancy
from weingarten.schedules.gradient_norm import GradientNorm
from weingarten.schedules.random_lookback import RandomLookback
from weingarten.schedules.schedule import Schedule, constant
from weingarten.schedules.seen import Seen
from weingarten.schedules.soft_adapt import SoftAdapt
from weingarten.schedules.task_priority import TaskPriority
from weingarten.schedules.uncertainty import Uncertainty
from weingarten.terms.dirichlet import DIRICHLET

__all__ = ["ADAPTIVE", "FULL", "Adaptive", "Rule", "Seen"]

FULL = constant(10.0)
"""The envelope unless told otherwise."""


@runtime_checkable
class Adaptive(Protocol):
    """A weight that follows what it watches. One fit's; mutable.

    gradients_every: 0 where it never needs gradients; k where it wants them at every k-th step.
    """

    @property
    def gradients_every(self) -> int: ...

    def __call__(self, t: float) -> float:
        """The weight for the step at progress t, given what was watched so far. Changes nothing."""
        ...

    def watch(self, seen: Seen) -> None:
        """After every step."""
        ...

    def state(self) -> dict[str, Any]:
        """All that it remembers, as plain JSON values."""
        ...

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`: a fresh one goes on from there, to the bit."""
        ...


@dataclass(frozen=True)
class Start:
    """What a rule may know beforehand.

    term: the scheduled one. reference: its weight where the rule has nothing to say. seed: of random draws.
    noise: mean distance of the points from their surface, unit lengths, each as far as it counts.
    """

    term: str
    reference: float
    seed: int
    noise: float


@dataclass(frozen=True)
class Rule:
    """A row of ADAPTIVE: what a method or the command line names.

    ratio: of the weight to its reference, for one fit. smoothing: memory of the average over the weight, as
    a share of the fit. watches: the one term that it cannot do without, if there is such a term.
    """

    name: str
    source: str
    ratio: Callable[[Start], Ratio]
    smoothing: float = SMOOTHING
    watches: str | None = None

    def begin(self, term: str, envelope: Schedule = FULL, seed: int = 0, noise: float = 0.0) -> Adaptive:
        """The weight of `term` for one fit.

        The reference weight is the envelope's greatest: it begins there, and the rule can take from it and
        give back. noise: only `discrepancy` asks, and raises OptionError where it is negative or not finite.
        """
        ratio = self.ratio(Start(term, envelope.greatest, seed, noise))
        return Bounded(ratio, envelope, self.smoothing)


def balancing(balancer: Callable[[Start], Balancer]) -> Callable[[Start], Ratio]:
    """The ratio of a rule that balances all losses."""
    return lambda start: Balance(start.term, start.reference, balancer(start))


ADAPTIVE: dict[str, Rule] = {
    rule.name: rule
    for rule in (
        Rule("kendall", "Kendall, Gal & Cipolla 2018, eq. 7", balancing(lambda start: Uncertainty())),
        Rule("gradnorm", "Chen et al. 2018, eq. 1, 2", balancing(lambda start: GradientNorm())),
        Rule("dtp", "Guo et al. 2018", balancing(lambda start: TaskPriority())),
        Rule("softadapt", "Heydari, Thompson & Mehmood 2019", balancing(lambda start: SoftAdapt())),
        Rule("relobralo", "Bischof & Kraus 2021", balancing(lambda start: RandomLookback(start.seed))),
        Rule(
            "discrepancy",
            "ours, after Morozov 1966",
            lambda start: Discrepancy(start.noise),
            smoothing=STEADY,
            watches=DIRICHLET.name,
        ),
    )
}
"""Adaptive weights by name."""

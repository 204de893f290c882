"""Weights as pure functions of progress t = step / steps ∈ [0, 1] (arXiv 2511.03147 §3).

Between the knots (s, w) and (e, w_e), with r = (t − s)/(e − s):

    linear    w + (w_e − w) r
    quintic   w + (w_e − w) (1 − (1 − r)⁵)
    step      w                         (the knot last passed: the paper's formula)
    step-next w_e                       (the knot to come: the paper's released code)
"""

import bisect
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

from weingarten.errors import OptionError

Knots = tuple[tuple[float, float], ...]

SHAPES: dict[str, Callable[[float], float]] = {
    "linear": lambda r: r,
    "quintic": lambda r: 1.0 - (1.0 - r) ** 5,
    "step": lambda r: 0.0,
    "step-next": lambda r: 1.0,
}
"""How far a weight has gone from one knot's value to the next one's, r ∈ [0, 1)."""

DECREASING: Knots = ((0.0, 10.0), (0.2, 10.0), (0.5, 0.001), (1.0, 0.0))
INCREASING: Knots = ((0.0, 0.0), (0.2, 0.0), (0.5, 9.999), (1.0, 10.0))
STANDING: Knots = ((0.0, 10.0),)


@dataclass(frozen=True)
class Schedule:
    """A weight over progress: `Schedule("quintic", knots)(t)`.

    Before the first knot the first value holds, from the last knot on the last value.
    Raises OptionError for knots out of order, outside [0, 1], negative or not finite.

    >>> Schedule("linear", DECREASING)(0.25)
    8.3335
    >>> Schedule("step", DECREASING)(0.3), Schedule("step-next", DECREASING)(0.3)
    (10.0, 0.001)
    """

    shape: str
    knots: Knots

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise OptionError(
                f"There is no schedule shape {self.shape!r}; choose one of {', '.join(SHAPES)}."
            )
        if not self.knots:
            raise OptionError("A schedule needs at least one knot, for example 0:10.")
        times = [time for time, _ in self.knots]
        if any(not 0.0 <= time <= 1.0 for time in times):
            raise OptionError(f"Knots must lie in [0, 1], where 1 is the end of the fit; got {times}.")
        if any(b <= a for a, b in pairwise(times)):
            raise OptionError(f"Knots must be in increasing order of time; got {times}.")
        weights = [weight for _, weight in self.knots]
        if any(not 0.0 <= weight < float("inf") for weight in weights):
            raise OptionError(f"Weights at knots must be finite and not negative; got {weights}.")

    def __call__(self, t: float) -> float:
        """The weight at progress t."""
        index = bisect.bisect_right([time for time, _ in self.knots], t)
        if index == 0:
            return self.knots[0][1]
        if index == len(self.knots):
            return self.knots[-1][1]
        (start, weight), (end, next_weight) = self.knots[index - 1], self.knots[index]
        share = SHAPES[self.shape]((t - start) / (end - start))
        return (1.0 - share) * weight + share * next_weight

    @property
    def greatest(self) -> float:
        """The greatest weight at a knot."""
        return max(weight for _, weight in self.knots)

    def begin(self, term: str, seed: int, noise: float) -> "Schedule":
        """Itself: a pure function is every fit's own. As `weingarten.schedules.weight.Adapted` has it."""
        return self

    def peaking(self, weight: float) -> "Schedule":
        """The same schedule scaled to that greatest weight; one that is zero throughout stays so."""
        factor = weight / self.greatest if self.greatest > 0.0 else 0.0
        return Schedule(self.shape, tuple((time, factor * value) for time, value in self.knots))


def constant(weight: float) -> Schedule:
    """The same weight throughout."""
    return Schedule("linear", ((0.0, weight),))


SCHEDULES: dict[str, Schedule] = {
    "constant": Schedule("linear", STANDING),
    "linear": Schedule("linear", DECREASING),
    "quintic": Schedule("quintic", DECREASING),
    "step": Schedule("step", DECREASING),
    "step-next": Schedule("step-next", DECREASING),
    "increasing": Schedule("linear", INCREASING),
    "none": constant(0.0),
}
"""The paper's schedules of the ODW weight by name (Tables 1 and 2), and that of a fit without it."""


def parse_knots(text: str) -> Knots:
    """Knots from the command line, "0:10,0.2:10,0.5:0.001,1:0" (time:weight)."""
    try:
        pairs = [tuple(float(number) for number in pair.split(":")) for pair in text.split(",")]
    except ValueError:
        pairs = []
    if not pairs or any(len(pair) != 2 for pair in pairs):
        raise OptionError(f"Knots are written time:weight,time:weight, for example 0:10,1:0; got {text!r}.")
    return tuple((pair[0], pair[1]) for pair in pairs)

"""The weight of a term as a method's row has it: a schedule, or a rule that adapts it under an envelope."""

from dataclasses import dataclass

from weingarten.errors import OptionError
from weingarten.schedules.adaptive import ADAPTIVE, Adaptive
from weingarten.schedules.schedule import SHAPES, Knots, Schedule


@dataclass(frozen=True)
class Adapted:
    """A weight that a rule of ADAPTIVE moves below an envelope. Raises OptionError for a name of no rule."""

    shape: str
    envelope: Schedule

    def __post_init__(self) -> None:
        if self.shape not in ADAPTIVE:
            raise OptionError(
                f"There is no adaptive weight {self.shape!r}; choose one of {', '.join(ADAPTIVE)}."
            )

    @property
    def knots(self) -> Knots:
        """Those of the envelope."""
        return self.envelope.knots

    @property
    def greatest(self) -> float:
        """The envelope's greatest weight, where the rule begins."""
        return self.envelope.greatest

    def peaking(self, weight: float) -> "Adapted":
        """The same rule below the envelope scaled to that greatest weight."""
        return Adapted(self.shape, self.envelope.peaking(weight))

    def begin(self, term: str, seed: int, noise: float) -> Adaptive:
        """One fit's own; see `Rule.begin`."""
        return ADAPTIVE[self.shape].begin(term, self.envelope, seed, noise)


Weight = Schedule | Adapted


def weight_of(shape: str, knots: Knots) -> Weight:
    """A schedule of that shape, or the rule of that name below the knots as a linear envelope.

    Raises OptionError for a name that is neither.
    """
    if shape in ADAPTIVE:
        return Adapted(shape, Schedule("linear", knots))
    if shape not in SHAPES:
        raise OptionError(f"There is no schedule {shape!r}; choose one of {', '.join((*SHAPES, *ADAPTIVE))}.")
    return Schedule(shape, knots)

"""What a method is: a loss, the field that it is of, and how that is differentiated."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from torch import nn

from weingarten.calculus.choice import Differences
from weingarten.calculus.jet import Calculus
from weingarten.errors import OptionError
from weingarten.fields.choice import FieldMaker
from weingarten.fields.siren import Siren
from weingarten.scan.knowledge import Knowledge, positions_alone
from weingarten.schedules.adaptive import ADAPTIVE
from weingarten.schedules.schedule import SCHEDULES, Knots, Schedule, constant
from weingarten.schedules.weight import Adapted, Weight
from weingarten.terms.off_diagonal_weingarten import OFF_DIAGONAL_WEINGARTEN
from weingarten.terms.term import Term

Differentiation = Callable[[nn.Module], Calculus]


@dataclass(frozen=True)
class Method:
    """A loss Σ weight(t) · mean residual, the field that it is of, and the calculus that feeds its terms.

    knowledge: what is known of the points that are drawn. field: from width, depth, ω₀ of the preset, and the
    generator. rate: times the preset's learning rate, which is for sine layers.
    scheduled: the term whose weight `--schedule` and `--knots` set, unless told otherwise.
    """

    name: str
    terms: dict[Term, Weight]
    calculus: Differentiation
    source: str
    scheduled: Term = OFF_DIAGONAL_WEINGARTEN
    knowledge: Knowledge = positions_alone
    field: FieldMaker = Siren
    rate: float = 1.0

    def scheduling(self, name: str) -> "Method":
        """The same method with another scheduled term. Raises OptionError for one that it has not."""
        found = {term.name: term for term in self.terms}
        if name not in found:
            raise OptionError(f"Method {self.name} has no term {name!r}; choose one of {', '.join(found)}.")
        return replace(self, scheduled=found[name])

    @property
    def step(self) -> Knots:
        """Distances of its stencil over progress; none where it has no stencil."""
        return self.calculus.step.knots if isinstance(self.calculus, Differences) else ()

    def with_step(self, knots: Knots) -> "Method":
        """The same method with its stencil at other distances. Raises OptionError where it has none."""
        if knots == self.step:
            return self
        if not isinstance(self.calculus, Differences):
            raise OptionError(f"Method {self.name} has no stencil, so no distance of it can be set.")
        return replace(self, calculus=self.calculus.with_step(Schedule("linear", knots)))

    @property
    def schedule(self) -> Weight:
        """The weight of the scheduled term."""
        return self.terms[self.scheduled]

    def with_schedule(self, schedule: Weight) -> "Method":
        """The same method with another weight of its scheduled term."""
        return replace(self, terms={**self.terms, self.scheduled: schedule})

    def named_schedule(self, name: str) -> Weight:
        """The schedule or adaptive weight of that name, scaled to this method's greatest weight."""
        if name in ADAPTIVE:
            return Adapted(name, constant(self.schedule.greatest))
        if name not in SCHEDULES:
            known = ", ".join((*SCHEDULES, *ADAPTIVE))
            raise OptionError(f"There is no schedule {name!r}; choose one of {known}.")
        return SCHEDULES[name].peaking(self.schedule.greatest)

"""What a method is: a loss, the field that it is of, and how that is differentiated."""

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from torch import nn

from weingarten.calculus.choice import Differences
from weingarten.calculus.jet import Calculus
from weingarten.errors import OptionError
from weingarten.fields.choice import FieldMaker
from weingarten.fields.siren import Siren
from weingarten.scan.knowledge import Knowledge, positions_alone
from weingarten.scan.preparation import AS_GIVEN, Preparation
from weingarten.schedules.adaptive import ADAPTIVE
from weingarten.schedules.schedule import SCHEDULES, Knots, Schedule, constant
from weingarten.schedules.weight import Adapted, Weight
from weingarten.terms.off_diagonal_weingarten import OFF_DIAGONAL_WEINGARTEN
from weingarten.terms.term import Term

Differentiation = Callable[[nn.Module], Calculus]


@dataclass(frozen=True)
class Method:
    """A loss Σ weight(t) · mean residual, the field that it is of, and the calculus that feeds its terms.

    knowledge: what is known of the points that are drawn. preparation: what is done about a scan's
    outliers and noise before. field: from width, depth, ω₀ of the preset, and the generator. rates: its
    learning rate by the optimiser's name, where the preset's is not for its field. made_for: name of the
    preset whose optimiser its weights are for; empty where they are for any.
    scheduled: the term whose weight `--schedule` and `--knots` set, unless told otherwise; None where there
    is no curvature term.
    """

    name: str
    terms: dict[Term, Weight]
    calculus: Differentiation
    source: str
    scheduled: Term | None = OFF_DIAGONAL_WEINGARTEN
    knowledge: Knowledge = positions_alone
    preparation: Preparation = AS_GIVEN
    field: FieldMaker = Siren
    rates: Mapping[str, float] = dataclasses.field(default_factory=dict)
    made_for: str = ""

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
    def scheduled_term(self) -> Term:
        """The scheduled term. Raises OptionError where there is none."""
        if self.scheduled is None:
            names = ", ".join(term.name for term in self.terms)
            raise OptionError(f"Method {self.name} has no curvature term; say --term, one of {names}.")
        return self.scheduled

    @property
    def schedule(self) -> Weight:
        """The weight of the scheduled term."""
        return self.terms[self.scheduled_term]

    def with_schedule(self, schedule: Weight) -> "Method":
        """The same method with another weight of its scheduled term."""
        return replace(self, terms={**self.terms, self.scheduled_term: schedule})

    def named_schedule(self, name: str) -> Weight:
        """The schedule or adaptive weight of that name, scaled to this method's greatest weight.

        Raises OptionError for a name of neither, and for a rule that watches a term that is not here.
        """
        if name in ADAPTIVE:
            self.check_watched(name, ADAPTIVE[name].watches)
            return Adapted(name, constant(self.schedule.greatest))
        if name not in SCHEDULES:
            known = ", ".join((*SCHEDULES, *ADAPTIVE))
            raise OptionError(f"There is no schedule {name!r}; choose one of {known}.")
        return SCHEDULES[name].peaking(self.schedule.greatest)

    def check_watched(self, rule: str, watched: str | None) -> None:
        """Raise OptionError where a rule watches a term that this method has not."""
        if watched is not None and watched not in (term.name for term in self.terms):
            raise OptionError(
                f"The weight {rule!r} watches the term {watched!r}, which method {self.name} has not."
            )

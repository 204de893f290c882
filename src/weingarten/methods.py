"""Every method is a row: which terms, under which schedules, differentiated how, and where it comes from."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import torch
from torch import nn

from weingarten.calculus.choice import Differences, exact
from weingarten.calculus.jet import Calculus
from weingarten.errors import OptionError
from weingarten.fields.siren import Siren
from weingarten.scan.knowledge import Knowledge, positions_alone, signs_of_free_space
from weingarten.schedules.adaptive import ADAPTIVE
from weingarten.schedules.schedule import SCHEDULES, Knots, Schedule, constant
from weingarten.schedules.weight import Adapted, Weight
from weingarten.terms.dirichlet import DIRICHLET
from weingarten.terms.eikonal import EIKONAL, EIKONAL_ABSOLUTE
from weingarten.terms.free_space import FREE_SPACE
from weingarten.terms.off_diagonal_weingarten import OFF_DIAGONAL_WEINGARTEN
from weingarten.terms.off_surface import OFF_SURFACE_TERM
from weingarten.terms.term import Term


@dataclass(frozen=True)
class Method:
    """A loss Σ weight(t) · mean residual, the field that it is of, and the calculus that feeds its terms.

    knowledge: what is known of the points that are drawn. field: from width, depth, ω₀ of the preset, and the
    generator. scheduled: the term whose weight `--schedule` and `--knots` set, unless told otherwise.
    """

    name: str
    terms: dict[Term, Weight]
    calculus: Callable[[nn.Module], Calculus]
    source: str
    scheduled: Term = OFF_DIAGONAL_WEINGARTEN
    knowledge: Knowledge = positions_alone
    field: Callable[[int, int, float, torch.Generator | None], nn.Module] = Siren

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


PAPER_TERMS: dict[Term, Weight] = {
    DIRICHLET: constant(7000.0),
    OFF_SURFACE_TERM: constant(600.0),
    EIKONAL: constant(50.0),
    OFF_DIAGONAL_WEINGARTEN: SCHEDULES["quintic"],
}
FEW_EIKONAL = replace(EIKONAL_ABSOLUTE, shares=(0.5, 1.0))
FEW_ODW = replace(OFF_DIAGONAL_WEINGARTEN, shares=(0.125,))
"""The dear terms on fewer points: the same mean, and its noise is not what limits a fit."""

RECIPE_TERMS: dict[Term, Weight] = {
    DIRICHLET: constant(7000.0),
    OFF_SURFACE_TERM: constant(100.0),
    FREE_SPACE: constant(1000.0),
    FEW_EIKONAL: constant(50.0),
    FEW_ODW: Schedule("quintic", ((0.0, 3.0), (0.1, 3.0), (0.3, 0.0))),
}

METHODS = {
    method.name: method
    for method in (
        Method(
            "odw",
            RECIPE_TERMS,
            exact,
            "arXiv 2511.03147 with signs from free space",
            FEW_ODW,
            signs_of_free_space,
        ),
        Method(
            "odw-fd",
            RECIPE_TERMS,
            Differences(),
            "arXiv 2506.16627 (FlatCAD-FD), signs from free space",
            FEW_ODW,
            signs_of_free_space,
        ),
        Method("odw-paper", PAPER_TERMS, exact, "arXiv 2511.03147, to the letter"),
        Method("odw-paper-fd", PAPER_TERMS, Differences(), "arXiv 2511.03147 by finite differences"),
    )
}


def method_named(name: str) -> Method:
    """A row of METHODS; OptionError lists what there is."""
    if name not in METHODS:
        raise OptionError(f"There is no method {name!r}; choose one of {', '.join(METHODS)}.")
    return METHODS[name]

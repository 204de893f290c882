"""Which calculus a field gets: exact jets by the fastest way there is for it, or stencils."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from torch import nn

from weingarten.calculus.analytic import Analytic
from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.central_gradient import CentralGradient
from weingarten.calculus.coarse_to_fine import CoarseToFine
from weingarten.calculus.composed import Composed
from weingarten.calculus.finite_difference import DIAGONAL, FiniteDifference, Stencil
from weingarten.calculus.jet import Calculus
from weingarten.calculus.native import Native, suits
from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren
from weingarten.fields.sphered import Sphered
from weingarten.schedules.schedule import Schedule, constant

AUTHORS_STEP = constant(0.05)
"""h of FlatCAD's and this paper's stencil, unit lengths, throughout."""


def exact(field: nn.Module) -> Calculus:
    """Exact jets: native ones of a float32 SIREN on a CPU, analytic ones of any other and of an ensemble.

    Composed ones of a field with an outer function; of any other module, autograd's.
    """
    if isinstance(field, Sphered):
        return Composed(field, exact(field.inner))
    if isinstance(field, Siren) and suits(field):
        return Native(field)
    return Analytic(field) if isinstance(field, Siren | Ensemble) else Autodiff(field)


def exact_gradients(field: nn.Module, distance: float) -> Calculus:
    """What a stencil starts from: exact values and gradients, whatever its distance."""
    return exact(field)


def central_gradients(field: nn.Module, distance: float) -> Calculus:
    """What a stencil starts from where a field's own gradients are local: central ones at its distance."""
    return CentralGradient(exact(field), distance)


@dataclass(frozen=True)
class Differences:
    """Second derivatives by a stencil, of any field: `Differences()(field)` is its calculus.

    step: the stencil's distance h over progress, unit lengths.
    inner: values and gradients, from a field and h.
    """

    stencil: Stencil = DIAGONAL
    step: Schedule = AUTHORS_STEP
    inner: Callable[[nn.Module, float], Calculus] = exact_gradients

    def __call__(self, field: nn.Module) -> Calculus:
        """A calculus that follows the schedule, or one that stays where that has a single knot."""

        def at(distance: float) -> Calculus:
            return FiniteDifference(self.inner(field, distance), distance, self.stencil)

        following = CoarseToFine(at, self.step)
        return following if len(self.step.knots) > 1 else following.at(0.0)

    def with_step(self, step: Schedule) -> "Differences":
        """The same stencil at other distances."""
        return replace(self, step=step)

"""A stencil that shrinks during the fit: its distance h is a schedule of progress (Neuralangelo, Li et al.
2023).

A wide stencil sees curvature of coarse shapes alone and smooths over the rest; a narrow one sees detail.
Starting wide and ending narrow lets coarse shapes settle first.
"""

from collections.abc import Callable

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import Calculus, Jet
from weingarten.errors import OptionError
from weingarten.schedules.schedule import Schedule


class CoarseToFine:
    """The calculus that `make` gives for the distance of the moment, unit lengths. A Progressive calculus.

    Called as it is, it is that of the end. Raises OptionError for a schedule that is ever zero.
    """

    def __init__(self, make: Callable[[float], Calculus], step: Schedule) -> None:
        if min(distance for _, distance in step.knots) <= 0.0:
            raise OptionError(f"A stencil's distance must stay above zero; got {step.knots}.")
        self.make = make
        self.step = step

    def at(self, t: float) -> Calculus:
        """See `weingarten.calculus.jet.Progressive`."""
        return self.make(self.step(t))

    def __call__(
        self, points: Float[Tensor, "n *m 3"], order: int, angles: Float[Tensor, "n *m"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        return self.at(1.0)(points, order, angles)

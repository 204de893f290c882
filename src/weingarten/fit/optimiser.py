"""What moves a field's weights: Adam and Muon do, and whatever else answers these questions."""

from collections.abc import Callable
from typing import Protocol, runtime_checkable

from torch import Tensor

Factor = float | Tensor
"""A number that a step multiplies by; where steps are replayed, a tensor without dimensions instead."""


@runtime_checkable
class Optimiser(Protocol):
    """Moves some of a field's weights by their gradients; the first dimension of an ensemble's are its parts.

    A step is in two halves. What it multiplies by is known beforehand, on the CPU; what it does with the
    weights is then the same at every step, and asks the device for nothing.
    """

    @property
    def size(self) -> int:
        """How many factors there are."""
        ...

    def step(self, rate: float) -> None:
        """Move the weights at this learning rate."""
        self.move(*self.factors(rate))

    def factors(self, rate: float) -> tuple[float, ...]:
        """What the next `move` is to multiply by; the step counts as taken."""
        ...

    def move(self, *factors: Factor) -> None:
        """Move every weight that has a gradient."""
        for job in self.jobs(*factors):
            job()

    def jobs(self, *factors: Factor) -> list[Callable[[], None]]:
        """The same in parts that may be done side by side."""
        ...

    def state(self) -> dict[str, Tensor]:
        """All that it remembers, for a checkpoint."""
        ...

    def restore(self, state: dict[str, Tensor]) -> None:
        """Remember this; KeyError where it is another's."""
        ...

"""Whoever watches a reconstruction; the default sees nothing and says nothing."""

from weingarten.fit.estimate import Estimate
from weingarten.fit.loop import Record


class Observer:
    """Override what is of interest. Every method is called from the thread that fits."""

    def note(self, text: str) -> None:
        """Something the user should know, one sentence."""

    def expect(self, estimate: Estimate, steps: int) -> None:
        """How long it will take, before the first step."""

    def step(self, record: Record, steps: int, seconds: float) -> None:
        """One step was taken."""

    def phase(self, name: str) -> None:
        """What comes next: preparing, fitting, extracting, measuring."""

    def interrupted(self) -> bool:
        """Whether to stop after this step and extract what there is."""
        return False

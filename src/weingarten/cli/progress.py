"""What a person sees while a fit runs: a bar on a terminal, plain lines elsewhere, nothing when quiet.

Everything goes to the standard error, so that the standard output holds results alone.
"""

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from weingarten.duration import duration
from weingarten.fit.estimate import Estimate
from weingarten.fit.loop import Record
from weingarten.observer import Observer

LINES = 20
"""Plain progress lines in a fit."""

PHASES = {
    "preparing": "Preparing the points",
    "extracting": "Extracting the surface",
    "measuring": "Measuring the result",
}


class Interruptible(Observer):
    """Knows that Ctrl-C was pressed once; a second one ends the program at once."""

    pressed = False

    def interrupted(self) -> bool:
        """See Observer."""
        return self.pressed

    def press(self, number: int, frame: FrameType | None) -> None:
        """The signal's handler."""
        if self.pressed:
            raise KeyboardInterrupt
        self.pressed = True

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Take Ctrl-C as a wish to stop after the step at hand."""
        previous = signal.signal(signal.SIGINT, self.press)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, previous)


class Quiet(Interruptible):
    """Says nothing."""


class Plain(Interruptible):
    """A line now and then."""

    def say(self, text: str) -> None:
        """One line on the standard error."""
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()

    def note(self, text: str) -> None:
        """See Observer."""
        self.say(f"Note: {text}")

    def phase(self, name: str) -> None:
        """See Observer."""
        if name in PHASES:
            self.say(f"{PHASES[name]}.")

    def expect(self, estimate: Estimate, steps: int) -> None:
        """See Observer."""
        self.say(expectation(estimate, steps))

    def step(self, record: Record, steps: int, seconds: float) -> None:
        """See Observer."""
        done = record.step + 1
        if done % max(1, steps // LINES) == 0 or done == steps:
            self.say(f"step {done}/{steps}  {remaining(seconds * (steps - done))}  {terms(record)}")


class Bar(Plain):
    """A progress bar with the time left and the terms."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        self.console = Console(stderr=True)
        self.bar = Progress(
            TextColumn("Fitting"),
            BarColumn(bar_width=24),
            TextColumn("{task.completed}/{task.total}"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[terms]}"),
            console=self.console,
            transient=True,
        )

    def say(self, text: str) -> None:
        """One line above the bar."""
        self.console.print(text, highlight=False, markup=False)

    def phase(self, name: str) -> None:
        """See Observer."""
        if name != "fitting":
            self.bar.stop()
        super().phase(name)

    def step(self, record: Record, steps: int, seconds: float) -> None:
        """See Observer."""
        if not self.bar.tasks:
            self.bar.start()
            self.bar.add_task("fit", total=steps, completed=record.step, terms="")
        self.bar.update(self.bar.tasks[0].id, completed=record.step + 1, terms=terms(record))

    @contextmanager
    def listening(self) -> Iterator[None]:
        """The bar is taken down whatever happens."""
        try:
            with super().listening():
                yield
        finally:
            self.bar.stop()


def progress(quiet: bool) -> Interruptible:
    """The one that fits where the standard error goes."""
    if quiet:
        return Quiet()
    return Bar() if sys.stderr.isatty() else Plain()


def expectation(estimate: Estimate, steps: int) -> str:
    """How long and how much, in a sentence."""
    return (
        f"About {duration(estimate.total)} ({steps:,} steps of {estimate.step:.2g} s, then the surface) "
        f"and {estimate.memory / 2**30:.1f} GB of memory."
    )


def remaining(seconds: float) -> str:
    """Time left."""
    return f"{duration(seconds)} left"


def terms(record: Record) -> str:
    """The unweighted means of the terms, short."""
    shown = [f"{short(name)} {value:.2g}" for name, value in record.terms.items() if value == value]
    return "  ".join(shown)


def short(name: str) -> str:
    """Initials of a long name, else the name."""
    return "".join(word[0] for word in name.split("_")).upper() if "_" in name else name

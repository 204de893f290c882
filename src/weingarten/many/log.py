"""What happened in a fit that nobody watches, for whoever looks into its folder."""

import datetime
from pathlib import Path

from weingarten.fit.estimate import Estimate
from weingarten.fit.loop import Record
from weingarten.observer import Observer

LINES = 10
"""Lines about the steps of a fit."""


class Log(Observer):
    """Adds to a file: an interrupted fit's lines stay."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __enter__(self) -> "Log":
        self.stream = self.path.open("a", encoding="utf-8")
        return self

    def __exit__(self, *_: object) -> None:
        self.stream.close()

    def say(self, text: str) -> None:
        """With the time."""
        now = datetime.datetime.now(datetime.UTC)
        self.stream.write(f"{now:%Y-%m-%d %H:%M:%S} {text}\n")
        self.stream.flush()

    def note(self, text: str) -> None:
        """See Observer."""
        self.say(f"Note: {text}")

    def expect(self, estimate: Estimate, steps: int) -> None:
        """See Observer."""
        self.say(f"About {estimate.total:.0f} s, {estimate.memory / 2**30:.1f} GB of memory.")

    def phase(self, name: str) -> None:
        """See Observer."""
        if name:
            self.say(f"{name.capitalize()}.")

    def step(self, record: Record, steps: int, seconds: float) -> None:
        """See Observer."""
        done = record.step + 1
        if done % max(1, steps // LINES) == 0 or done == steps:
            self.say(f"Step {done} of {steps}, loss {record.loss:.4g}.")

"""What a person sees while many fits are made: which one, how far, and when all will be done.

Everything goes to the standard error, so that the standard output holds results alone.
"""

import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from weingarten.duration import duration
from weingarten.many.runner import Batch, Watcher


class Quiet(Watcher):
    """Says nothing."""

    def __enter__(self) -> "Quiet":
        return self

    def __exit__(self, *error: object) -> None:
        return None


class Lines(Quiet):
    """A line when a fit has ended. clock: seconds, from any origin."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.clock = clock
        self.waiting: Batch = ()
        self.ended: Counter[str] = Counter()
        self.taken: dict[str, float] = {}
        self.begun: dict[Path, float] = {}
        self.most = 1
        self.left: Counter[str] = Counter()

    def say(self, text: str) -> None:
        """One line that stays."""
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()

    def show(self, text: str) -> None:
        """What passes: nothing here."""

    def plan(self, jobs: Batch, waiting: Batch) -> None:
        """See Watcher."""
        self.waiting = waiting
        self.left = Counter(job.kind for job in waiting)
        self.say(f"{len(jobs)} fits, {len(jobs) - len(waiting)} of them done before.")

    def note(self, text: str) -> None:
        """See Watcher."""
        self.say(f"Note: {text}")

    def begin(self, batch: Batch) -> None:
        """See Watcher."""
        self.begun[batch[0].folder] = self.clock()
        self.most = max(self.most, len(self.begun))
        self.show(f"{self.position(batch)} …{self.beside()}")

    def look(self, batch: Batch, step: int | None) -> None:
        """See Watcher."""
        far = "" if step is None else f", step {step + 1}"
        taken = duration(self.clock() - self.begun[batch[0].folder])
        self.show(f"{self.position(batch)}{far}, {taken}{self.beside()}{self.remaining()}")

    def end(self, batch: Batch) -> None:
        """See Watcher."""
        each = (self.clock() - self.begun.pop(batch[0].folder)) / len(batch)
        for job in batch:
            at = self.position([job])
            self.left[job.kind] -= 1
            self.ended[job.kind] += 1
            self.taken[job.kind] = self.taken.get(job.kind, 0.0) + each
            error = job.error
            self.say(f"{at}: {f'failed: {error}' if error else 'done'}{self.remaining()}")

    def position(self, batch: Batch) -> str:
        """Which of how many, and which it is."""
        more = f" and {len(batch) - 1} more parts" if len(batch) > 1 else ""
        return f"[{self.ended.total() + 1}/{len(self.waiting)}] {batch[0].name}{more}"

    def beside(self) -> str:
        """How many others are under way."""
        return f", {len(self.begun) - 1} more at once" if len(self.begun) > 1 else ""

    def remaining(self) -> str:
        """Until all fits are done: each takes what its kind has taken so far, or the mean of all.

        As many go on at once as ever did.
        """
        if not self.ended or not self.left.total():
            return ""
        mean = sum(self.taken.values()) / self.ended.total()
        means = {kind: self.taken[kind] / count for kind, count in self.ended.items()}
        seconds = sum(count * means.get(kind, mean) for kind, count in self.left.items())
        return f"; {duration(seconds / self.most)} left for all"


class Status(Lines):
    """The same, and a last line that always says what is going on."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        from rich.console import Console

        super().__init__(clock)
        self.console = Console(stderr=True)
        self.status = self.console.status("")

    def __enter__(self) -> "Status":
        self.status.start()
        return self

    def __exit__(self, *error: object) -> None:
        self.status.stop()

    def say(self, text: str) -> None:
        """See Lines."""
        self.console.print(text, highlight=False, markup=False)

    def show(self, text: str) -> None:
        """See Lines."""
        from rich.markup import escape

        self.status.update(escape(text))

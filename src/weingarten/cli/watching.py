"""What a person sees while a benchmark runs: which fit, how far, and when all will be done.

Everything goes to the standard error, so that the standard output holds results alone.
"""

import sys
import time
from collections.abc import Callable, Sequence
from typing import Self

from weingarten.bench.job import Job
from weingarten.bench.runner import Watcher
from weingarten.duration import duration


class Quiet(Watcher):
    """Says nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        return None


class Lines(Quiet):
    """A line when a fit has ended. clock: seconds, from any origin."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.clock = clock
        self.waiting: Sequence[Job] = ()
        self.taken: dict[str, list[float]] = {}
        self.ended = 0

    def say(self, text: str) -> None:
        """One line that stays."""
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()

    def show(self, text: str) -> None:
        """What passes: nothing here."""

    def plan(self, jobs: Sequence[Job], waiting: Sequence[Job]) -> None:
        """See Watcher."""
        self.waiting = waiting
        self.say(f"{len(jobs)} fits, {len(jobs) - len(waiting)} of them done before.")

    def begin(self, batch: Sequence[Job]) -> None:
        """See Watcher."""
        self.started = self.clock()
        self.show(f"{self.position(batch)} …")

    def look(self, batch: Sequence[Job], step: int | None) -> None:
        """See Watcher."""
        far = "" if step is None else f", step {step + 1}"
        self.show(f"{self.position(batch)}{far}, {duration(self.clock() - self.started)}{self.left()}")

    def end(self, batch: Sequence[Job]) -> None:
        """See Watcher."""
        each = (self.clock() - self.started) / len(batch)
        for job in batch:
            at = self.position([job])
            self.ended += 1
            self.taken.setdefault(job.contender.name, []).append(each)
            error = job.entry.error
            self.say(f"{at}: {f'failed: {error}' if error else 'done'}{self.left()}")

    def position(self, batch: Sequence[Job]) -> str:
        """Which of how many, and which it is."""
        first, more = batch[0], f" and {len(batch) - 1} more parts" if len(batch) > 1 else ""
        number = f"[{self.ended + 1}/{len(self.waiting)}]"
        return f"{number} {first.part.name}{more}, {first.contender.name}, seed {first.seed}"

    def left(self) -> str:
        """Until all fits are done: each takes what its contender's have taken so far, or the mean of all."""
        every = [seconds for own in self.taken.values() for seconds in own]
        if not every or self.ended == len(self.waiting):
            return ""
        mean = sum(every) / len(every)
        means = {name: sum(own) / len(own) for name, own in self.taken.items()}
        seconds = sum(means.get(job.contender.name, mean) for job in self.waiting[self.ended :])
        return f"; {duration(seconds)} left for all"


class Status(Lines):
    """The same, and a last line that always says what is going on."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        from rich.console import Console

        super().__init__(clock)
        self.console = Console(stderr=True)
        self.status = self.console.status("")

    def __enter__(self) -> Self:
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

"""Many jobs, whoever does them: processes of this machine (`many.workers`) or a cluster (`many.cluster`)."""

from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from typing import Protocol, runtime_checkable

from weingarten.many.job import Job
from weingarten.many.threads import Threads

Batch = Sequence[Job]
"""Jobs that one process does together, mostly one."""

POLL = 2.0
"""Seconds between two looks at what is being done."""


class Watcher:
    """Whoever watches; the default sees nothing. All methods are called by the thread that hands out jobs."""

    def plan(self, jobs: Batch, waiting: Batch) -> None:
        """What there is, and what of it is still to be done."""

    def note(self, text: str) -> None:
        """Something the user should know, one sentence."""

    def begin(self, batch: Batch) -> None:
        """Somebody is given these; others may be under way."""

    def look(self, batch: Batch, step: int | None) -> None:
        """They go on; step: of the last loss in the first one's folder, where that is known."""

    def end(self, batch: Batch) -> None:
        """They have ended, well or not: they say which."""


class Several(Watcher):
    """Watchers that all see the same."""

    def __init__(self, *watchers: Watcher) -> None:
        self.watchers = watchers

    def plan(self, jobs: Batch, waiting: Batch) -> None:
        """See Watcher."""
        for one in self.watchers:
            one.plan(jobs, waiting)

    def note(self, text: str) -> None:
        """See Watcher."""
        for one in self.watchers:
            one.note(text)

    def begin(self, batch: Batch) -> None:
        """See Watcher."""
        for one in self.watchers:
            one.begin(batch)

    def look(self, batch: Batch, step: int | None) -> None:
        """See Watcher."""
        for one in self.watchers:
            one.look(batch, step)

    def end(self, batch: Batch) -> None:
        """See Watcher."""
        for one in self.watchers:
            one.end(batch)


@runtime_checkable
class Crowd(Protocol):
    """Whoever does jobs, several at once. threads: of each batch."""

    threads: Threads

    def device(self, name: str) -> str:
        """The device of that name where the jobs are done, auto decided. Raises OptionError, DeviceError."""
        ...

    def perform(self, batches: Iterable[Batch], watcher: Watcher) -> None:
        """Do all of them and note every failure; the watcher is told."""
        ...

    def working(self) -> AbstractContextManager[None]:
        """To ask for devices and to perform within; at its end nothing goes on, whatever happened."""
        ...


def run(jobs: Batch, waiting: Sequence[Batch], watcher: Watcher, crowd: Crowd) -> None:
    """Have done what is still to be done, within `crowd.working()`. waiting: of `jobs`, in batches."""
    watcher.plan(jobs, [job for batch in waiting for job in batch])
    crowd.perform(waiting, watcher)


def shared(jobs: Sequence, shard: tuple[int, int]) -> list:
    """The i-th of n shares, i from 1; all shares together are all of it, and nothing twice."""
    index, count = shard
    return list(jobs[index - 1 :: count])

"""The fits of a benchmark, one after another in a process of their own, so that no other dies with one.

Fits are ordered by seed, part and contender: those that are compared are made side by side, and what is there
after a while is a whole benchmark of fewer seeds.
"""

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures import TimeoutError as NotYet
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from pathlib import Path

from weingarten.bench import job as work
from weingarten.bench.contender import Contender
from weingarten.bench.job import DONE, FAILED, Job
from weingarten.bench.parts import Part
from weingarten.bench.store import Store, make_folder
from weingarten.errors import OptionError

POLL = 2.0
"""Seconds between two looks at a running fit."""


@dataclass(frozen=True)
class Plan:
    """Which fits a benchmark consists of. shard: (i, n) for the i-th of n equal shares, i from 1."""

    store: Store
    parts: Sequence[Part]
    contenders: Sequence[Contender]
    seeds: int
    points: int
    device: str
    origin: dict[str, str]
    shard: tuple[int, int] = (1, 1)

    def jobs(self) -> list[Job]:
        """In order. Raises OptionError where the folder holds another fit in one of these places."""
        jobs = [
            Job(self.store, part, contender, seed, self.points, self.device, self.origin)
            for seed in range(self.seeds)
            for part in self.parts
            for contender in self.contenders
        ]
        for job in jobs:
            check_same(job)
        index, count = self.shard
        return jobs[index - 1 :: count]


class Watcher:
    """Whoever watches a benchmark; the default sees nothing. A batch is of jobs that are done together."""

    def plan(self, jobs: Sequence[Job], waiting: Sequence[Job]) -> None:
        """What there is, and what of it is still to be made."""

    def begin(self, batch: Sequence[Job]) -> None:
        """Fits begin."""

    def look(self, batch: Sequence[Job], step: int | None) -> None:
        """Fits go on; step: of the last loss in the first one's folder."""

    def end(self, batch: Sequence[Job]) -> None:
        """Fits have ended, well or not: their entries say which."""


def run(jobs: Sequence[Job], watcher: Watcher, retry: bool, workers: "Workers", together: int = 1) -> None:
    """Make every fit that is not done. retry: those that failed as well. together: so many parts at once."""
    waiting = [job for job in jobs if not done(job, retry)]
    watcher.plan(jobs, waiting)
    with workers.closing():
        for batch in batches(waiting, together):
            watcher.begin(batch)
            workers.perform(batch, watcher)
            watcher.end(batch)


def batches(jobs: Sequence[Job], together: int) -> list[list[Job]]:
    """The jobs in order; of one contender and seed up to so many together, where that is more than one."""
    if together == 1:
        return [[job] for job in jobs]
    alike: dict[tuple[int, str], list[Job]] = {}
    for job in jobs:
        alike.setdefault((job.seed, job.contender.name), []).append(job)
    return [own[start : start + together] for own in alike.values() for start in range(0, len(own), together)]


def done(job: Job, retry: bool) -> bool:
    """Whether a job's mesh was made and judged, or failed for good."""
    if job.entry.error:
        return not retry
    return job.entry.fit.get("status") == DONE and work.judged(job)


class Workers:
    """One process at a time; another takes its place when it dies. setup: called first in each."""

    def __init__(self, setup: Callable[[], None]) -> None:
        self.setup = setup
        self.pool: ProcessPoolExecutor | None = None

    def perform(self, batch: Sequence[Job], watcher: Watcher) -> None:
        """Fit and judge in the process; its death is noted with whatever it had not finished."""
        if self.pool is None:
            self.pool = ProcessPoolExecutor(1, get_context("spawn"), initializer, (self.setup,))
        try:
            self.await_end(self.pool.submit(work.perform, batch), batch, watcher)
        except BrokenProcessPool:
            self.pool = None
            for job in batch:
                note_death(job)

    def await_end(self, future: Future, batch: Sequence[Job], watcher: Watcher) -> None:
        """Look now and then until all have ended."""
        while True:
            try:
                return future.result(POLL)
            except NotYet:
                watcher.look(batch, last_step(batch[0].entry.curve_path))

    @contextmanager
    def closing(self) -> Iterator[None]:
        """The process is ended at once, whatever happens: an unfinished fit is resumed another time."""
        try:
            yield
        finally:
            if self.pool is not None:
                for process in list(self.pool._processes.values()):
                    process.kill()
                self.pool.shutdown(cancel_futures=True)


def note_death(job: Job) -> None:
    """What a process that died had not finished has failed; a mesh that it had made stays."""
    died = {"status": FAILED, "error": "The process died; it may have run out of memory."}
    make_folder(job.entry.folder)
    if job.entry.fit.get("status") != DONE:
        job.entry.write_fit(job.record | died)
    elif not work.judged(job):
        job.entry.write_figures(died)


def initializer(setup: Callable[[], None]) -> None:
    """Before the first fit of a process: Ctrl-C is for its parent, with whose death it ends as well.

    Else it would go on when its parent was killed, beside that of the benchmark begun again.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=end_with_parent, daemon=True).start()
    setup()


def end_with_parent() -> None:
    """Wait for the death of the process that began this one."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def last_step(curve: Path) -> int | None:
    """Of a loss curve that is being written; None before its first."""
    if not curve.exists():
        return None
    with curve.open("rb") as stream:
        stream.seek(max(0, curve.stat().st_size - 4096))
        lines = stream.read().splitlines()
    numbers = [line.split(b",")[0] for line in lines[1:]]
    return next((int(number) for number in reversed(numbers) if number.isdigit()), None)


def check_same(job: Job) -> None:
    """Raise OptionError where the job's place holds a fit of other settings, or of another truth."""
    truth = job.store.truth(job.part.name)
    if truth and truth["sha256"] != work.fingerprint(job.part):
        raise OptionError(
            f"{job.part.truth} is not the mesh that {job.store.path} was made with; choose another --out."
        )
    found = job.entry.fit
    for key, value in job.identity.items():
        if found and found.get(key) != value:
            raise OptionError(
                f"{job.entry.folder} holds a fit with another {key}; choose another --out for this benchmark."
            )

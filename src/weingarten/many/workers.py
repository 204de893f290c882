"""Processes of this machine: each does one batch at a time, so that no other dies with one."""

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context, parent_process
from pathlib import Path

from weingarten.device import chosen_device
from weingarten.many.job import FAILED, failure
from weingarten.many.runner import POLL, Batch, Watcher
from weingarten.many.threads import Threads

DIED = "The process died; it may have run out of memory."


class Workers:
    """So many processes at once; another takes a place when one dies. setup: called first in each.

    threads: what each may use; by default what a process of its own would.
    """

    def __init__(self, setup: Callable[[], object], count: int = 1, threads: Threads | None = None) -> None:
        self.setup = setup
        self.threads = threads or Threads()
        self.pools: list[ProcessPoolExecutor | None] = [None] * count

    def device(self, name: str) -> str:
        """See Crowd."""
        return str(chosen_device(name))

    def perform(self, batches: Iterable[Batch], watcher: Watcher) -> None:
        """See Crowd. A process's death is noted with whatever it had not finished."""
        waiting = iter(batches)
        running: dict[Future, tuple[int, Batch]] = {}
        free = list(range(len(self.pools)))
        while True:
            while free and (batch := next(waiting, None)) is not None:
                place = free.pop(0)
                watcher.begin(batch)
                running[self.submitted(place, batch)] = place, batch
            if not running:
                return
            ended = wait(running, POLL, FIRST_COMPLETED).done
            for future in ended:
                place, batch = running.pop(future)
                self.conclude(future, place, batch)
                free.append(place)
                watcher.end(batch)
            if not ended:
                for _, batch in running.values():
                    watcher.look(batch, last_step(batch[0].curve))

    def submitted(self, place: int, batch: Batch) -> Future:
        """What the process of a place will have done; another process where that one died while it waited."""
        with self.threads.inherited():
            try:
                return self.pool(place).submit(perform, batch)
            except BrokenProcessPool:
                self.pools[place] = None
                return self.pool(place).submit(perform, batch)

    def pool(self, place: int) -> ProcessPoolExecutor:
        """The one of a place, which holds one process."""
        found = self.pools[place]
        if found is None:
            given = (self.setup, self.threads)
            found = self.pools[place] = ProcessPoolExecutor(1, get_context("spawn"), initializer, given)
        return found

    def conclude(self, future: Future, place: int, batch: Batch) -> None:
        """Note what was left undone by a process that died, or by an error that was not noted."""
        try:
            future.result()
        except BrokenProcessPool:
            self.pools[place] = None
            failed = {"status": FAILED, "error": DIED}
        except Exception as error:
            failed = failure(error)
        else:
            return
        for job in batch:
            job.note_failure(failed)

    @contextmanager
    def working(self) -> Iterator[None]:
        """See Crowd. The processes are ended at once: an unfinished fit is resumed another time."""
        try:
            yield
        finally:
            for pool in self.pools:
                if pool is not None:
                    for process in list((pool._processes or {}).values()):
                        process.kill()
                    pool.shutdown(cancel_futures=True)
            self.pools = [None] * len(self.pools)


def perform(batch: Batch) -> None:
    """In the process: whatever the jobs are."""
    type(batch[0]).perform(batch)


def initializer(setup: Callable[[], object], threads: Threads) -> None:
    """Before the first job of a process: Ctrl-C is for its parent, with whose death it ends as well.

    Else it would go on when its parent was killed, beside that of the same command begun again.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=end_with_parent, daemon=True).start()
    threads.take()
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

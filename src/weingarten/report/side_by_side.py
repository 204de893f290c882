"""The pictures of several parts at once, in a few processes, for every part takes many seconds."""

import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context

from weingarten.bench.results import Result
from weingarten.bench.store import Store
from weingarten.report.gallery import PartView, part_view

FEW = 3
"""So many parts are not worth the seconds that another process takes to begin."""
MOST = 4
"""Processes; each may hold a mesh of millions of triangles."""


def part_views(
    store: Store, found: Sequence[Result], parts: Sequence[str], names: Sequence[str], triangles: int
) -> Iterator[PartView]:
    """`part_view` of every part, in order."""
    workers = min(MOST, os.cpu_count() or 1, len(parts))
    made = 0
    if workers > 1 and len(parts) > FEW:
        pool = ProcessPoolExecutor(workers, get_context("spawn"), deaf)
        try:
            futures = [
                pool.submit(part_view, store, of(part, found), part, names, triangles) for part in parts
            ]
            for future in futures:
                yield future.result()
                made += 1
        except BrokenProcessPool:  # one died, perhaps for want of memory; alone there is more of it
            pass
        finally:
            for process in list((pool._processes or {}).values()):
                process.kill()
            pool.shutdown(cancel_futures=True)
    for part in parts[made:]:
        yield part_view(store, found, part, names, triangles)


def of(part: str, found: Sequence[Result]) -> list[Result]:
    """The fits of a part."""
    return [one for one in found if one.part == part]


def deaf() -> None:
    """Of a process: Ctrl-C is for the one that waits for it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

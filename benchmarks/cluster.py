"""What a Ray cluster costs beside the fits: a task that carries the files of a run folder and does nothing.

    python benchmarks/cluster.py CLOUD RUN [--tasks 200] [--ray local]

CLOUD is a cloud's file, which each task is sent; RUN a run folder, whose files each sends back. The driver
writes them as it does those of a fit. The first line has neither. One task a core at a time, as for fits.
"""

import argparse
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from table import table

from weingarten.many.cluster import Ray
from weingarten.many.job import DONE, Job, files_in
from weingarten.many.records import make_folder, write
from weingarten.many.runner import Watcher


@dataclass(frozen=True)
class Nothing(Job):
    """Copies what it is sent into its folder. number: its name."""

    place: Path
    number: int
    given: tuple[Path, ...] = ()

    @property
    def name(self) -> str:
        """See Job."""
        return str(self.number)

    @property
    def kind(self) -> str:
        """See Job."""
        return ""

    @property
    def root(self) -> Path:
        """See Job."""
        return self.place

    @property
    def folder(self) -> Path:
        """See Job."""
        return self.place / self.name

    @property
    def error(self) -> str:
        """See Job."""
        return ""

    @classmethod
    def perform(cls, batch: Sequence["Nothing"]) -> None:
        """See Job."""
        for job in batch:
            make_folder(job.folder)
            for path in job.given:
                shutil.copyfile(path, job.folder / path.name)
            write(job.folder / "fit.json", {"status": DONE})

    def note_failure(self, failed: dict[str, Any]) -> None:
        """See Job."""
        raise SystemExit(failed["error"])

    def sources(self) -> list[Path]:
        """See Job."""
        return list(self.given)

    def kept(self) -> list[Path]:
        """See Job."""
        return []

    def moved(self, root: Path, sources: Path) -> "Nothing":
        """See Job."""
        return replace(self, place=root, given=tuple(sources / path.name for path in self.given))


def seconds(ray: Ray, tasks: int, given: tuple[Path, ...]) -> tuple[float, float]:
    """Of each task, wall clock with as many at once as there are cores, and the driver's processor."""
    with tempfile.TemporaryDirectory() as folder:
        ray.perform([[Nothing(Path(folder), number, given)] for number in range(8)], Watcher())
        started, before = time.perf_counter(), time.process_time()
        ray.perform([[Nothing(Path(folder), 8 + number, given)] for number in range(tasks)], Watcher())
        return (time.perf_counter() - started) / tasks, (time.process_time() - before) / tasks


def main() -> int:
    """Parse, run, print; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("cloud", type=Path)
    parser.add_argument("run", type=Path)
    parser.add_argument("--tasks", type=int, default=200)
    parser.add_argument("--ray", default="local", metavar="ADDRESS")
    arguments = parser.parse_args()
    ray = Ray(os.getpid, arguments.ray)
    lines = []
    with ray.working():
        ray.device("cpu")
        for what, given in (("nothing", ()), ("a run", (arguments.cloud, *files_in(arguments.run)))):
            size = sum(path.stat().st_size for path in given) / 1e6
            taken = [f"{1000 * one:.1f}" for one in seconds(ray, arguments.tasks, given)]
            lines.append([what, f"{size:.2f}", *taken])
    sys.stdout.write(table(["carried", "MB each way", "ms a task", "of the driver's processor"], lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())

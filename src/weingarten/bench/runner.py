"""The fits of a benchmark, in processes of their own or on other machines, so that no other dies with one.

Fits are ordered by seed, part and contender: those that are compared are made side by side, and what is there
after a while is a whole benchmark of fewer seeds.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from weingarten.bench import job as work
from weingarten.bench.contender import Contender
from weingarten.bench.job import DONE, Job
from weingarten.bench.parts import Part
from weingarten.bench.store import Store
from weingarten.errors import OptionError
from weingarten.many import runner
from weingarten.many.runner import Crowd, Watcher, shared


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
        return shared(jobs, self.shard)


def run(jobs: Sequence[Job], watcher: Watcher, retry: bool, crowd: Crowd, together: int = 1) -> None:
    """Make every fit that is not done. retry: those that failed as well. together: so many parts at once."""
    waiting = [job for job in jobs if not done(job, retry)]
    runner.run(jobs, batches(waiting, together), watcher, crowd)


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

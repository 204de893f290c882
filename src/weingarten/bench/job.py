"""Fits of a benchmark, from the scan to their figures, in whichever process they run."""

import hashlib
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import psutil

from weingarten.bench.contender import Contender, Made, Scan
from weingarten.bench.parts import Part
from weingarten.bench.store import Entry, Store
from weingarten.device import chosen_device
from weingarten.fit.run_folder import opened
from weingarten.many import job as many
from weingarten.many.job import DONE, FAILED, failure, files_in
from weingarten.many.records import make_folder
from weingarten.mesh import Mesh
from weingarten.metrics.protocol import EXACT, FIELD, PUBLISHED
from weingarten.report.provenance import machine
from weingarten.world_field import WorldField

__all__ = ["DONE", "FAILED", "Job"]


@dataclass(frozen=True)
class Job(many.Job):
    """One contender on one part with one seed. points: of the scan, where the part has no cloud of its own.

    origin: where it is done, for the record: machine, version, commit, date.
    """

    store: Store
    part: Part
    contender: Contender
    seed: int
    points: int
    device: str
    origin: dict[str, str]

    @property
    def entry(self) -> Entry:
        """Its place."""
        return self.store.entry(self.part.name, self.contender.name, self.seed)

    @property
    def identity(self) -> dict[str, Any]:
        """What a finished fit must agree in, to be this one."""
        scan = {"points": self.points} if self.part.cloud is None else {"cloud": self.part.cloud.name}
        return {
            "part": self.part.name,
            "contender": self.contender.name,
            "seed": self.seed,
            "settings": self.contender.description(),
            "scan": scan,
        }

    @property
    def record(self) -> dict[str, Any]:
        """What is noted of the fit, whatever becomes of it."""
        where = {"truth": str(self.part.truth.resolve()), "device": self.device}
        return {**self.identity, **where, **self.origin}

    @property
    def name(self) -> str:
        """See many.Job."""
        return f"{self.part.name}, {self.contender.name}, seed {self.seed}"

    @property
    def kind(self) -> str:
        """See many.Job: the contender."""
        return self.contender.name

    @property
    def root(self) -> Path:
        """See many.Job."""
        return self.store.path

    @property
    def folder(self) -> Path:
        """See many.Job."""
        return self.entry.folder

    @property
    def error(self) -> str:
        """See many.Job."""
        return self.entry.error

    @classmethod
    def perform(cls, batch: Sequence["Job"]) -> None:
        """See many.Job."""
        perform(batch)

    def note_failure(self, failed: dict[str, Any]) -> None:
        """See many.Job. A mesh that was made stays."""
        make_folder(self.folder)
        if self.entry.fit.get("status") != DONE:
            self.entry.write_fit(self.record | failed)
        elif not judged(self):
            self.entry.write_figures(failed)

    def sources(self) -> list[Path]:
        """See many.Job."""
        return [self.part.truth, *([] if self.part.cloud is None else [self.part.cloud])]

    def kept(self) -> list[Path]:
        """See many.Job: its folder, and what its part's other fits have left for it."""
        shared = (self.store.scan_path(self.part, self.seed), self.store.truth_path(self.part.name))
        return [*files_in(self.folder), *(path for path in shared if path.exists())]

    def moved(self, root: Path, sources: Path) -> "Job":
        """See many.Job. The record still says where the truth was, and says which machine it is done by."""
        cloud = None if self.part.cloud is None else sources / self.part.cloud.name
        part = replace(self.part, truth=sources / self.part.truth.name, cloud=cloud)
        origin = {**self.origin, "truth": self.record["truth"], "machine": machine()}
        return replace(self, store=Store(root), part=part, origin=origin)


def perform(jobs: Sequence[Job]) -> None:
    """Make the meshes that are not there and judge what was not judged. What goes wrong is noted.

    jobs: of one contender and seed, which are made together if it can.
    """
    for job in jobs:
        make_folder(job.entry.folder)
    fields = make([job for job in jobs if job.entry.fit.get("status") != DONE])
    for job in jobs:
        if job.entry.fit["status"] == DONE and not judged(job):
            job.entry.write_figures(figures(job, fields.get(job.part.name)))


def judged(job: Job) -> bool:
    """Whether a fit has its figures, by today's protocols; those of a field only where it left one."""
    found = job.entry.figures
    return "error" not in found and PUBLISHED.name in found and EXACT.name in found


def make(jobs: Sequence[Job]) -> dict[str, WorldField]:
    """Make the meshes and note how: seconds from points in memory to the mesh, of one of so many.

    The fields that are nowhere else, by part.
    """
    ready: dict[int, Scan] = {}
    for index, job in enumerate(jobs):
        try:
            ready[index] = scan_of(job)
        except Exception as error:
            job.entry.write_fit(job.record | failure(error))
    if not ready:
        return {}
    process = psutil.Process()
    before, started = process.cpu_times(), time.perf_counter()
    outcomes = attempt_all(jobs[0].contender, list(ready.values()))
    wall, after = time.perf_counter() - started, process.cpu_times()
    cost = {
        "seconds": wall / len(ready),
        "cpu_seconds": (after.user + after.system - before.user - before.system) / len(ready),
        "together": len(ready),
    }
    fields = {}
    for index, made in zip(ready, outcomes, strict=True):
        job = jobs[index]
        job.entry.write_fit(
            job.record | (failure(made) if isinstance(made, Exception) else success(made, cost))
        )
        if isinstance(made, Made) and made.field is not None:
            fields[job.part.name] = made.field
    return fields


def attempt_all(contender: Contender, scans: Sequence[Scan]) -> list[Made | Exception]:
    """What was made of every scan, or the error; one that befell all of them stands for each."""
    try:
        return contender.make_all(scans)
    except Exception as error:
        return [error] * len(scans)


def scan_of(job: Job) -> Scan:
    """What the contender is given. Raises InputError for a truth or cloud that cannot be read."""
    truth = job.part.mesh()
    keep_ceiling(job, truth)
    points = job.store.scan(job.part, job.points, job.seed)
    shown = truth if job.contender.oracle else None
    return Scan(points, job.seed, job.device, job.entry.folder, shown)


def success(made: Made, cost: dict[str, Any]) -> dict[str, Any]:
    """What is noted of a fit that was made."""
    return {
        "status": DONE,
        **cost,
        "seconds": made.earlier + cost["seconds"],
        "resumed": made.earlier > 0,
        "phases": made.phases or {},
        "notes": list(made.notes),
    }


def keep_ceiling(job: Job, truth: Mesh) -> None:
    """Note once what the truth scores against itself, and which file it is."""
    if job.store.truth(job.part.name).get("protocol") == PUBLISHED.name:
        return
    ceiling = PUBLISHED.ceiling(truth)
    values = {"protocol": PUBLISHED.name, "ceiling": ceiling.values(), "sha256": fingerprint(job.part)}
    job.store.write_truth(job.part.name, values)


def figures(job: Job, field: WorldField | None) -> dict[str, Any]:
    """Of the mesh, and of the field where there is one, by protocol; or why there are none.

    field: where the fit's folder does not hold it.
    """
    try:
        truth, mesh = job.part.mesh(), job.entry.mesh()
        keep_ceiling(job, truth)
        found = [PUBLISHED.evaluate(mesh, truth), EXACT.evaluate(mesh, truth)]
        if field is None and job.entry.checkpoint_path.exists():
            field = WorldField.of(opened(job.entry.folder)[0], chosen_device("cpu"))
        if field is not None:
            found.append(FIELD.evaluate(field, truth))
    except Exception as error:
        return failure(error)
    return {one.protocol: one.as_dict() for one in found}


def fingerprint(part: Part) -> str:
    """Of the truth's file."""
    return hashlib.sha256(part.truth.read_bytes()).hexdigest()

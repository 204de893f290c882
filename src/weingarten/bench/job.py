"""One fit of a benchmark, from the scan to its figures, in whichever process it runs."""

import hashlib
import time
import traceback
from dataclasses import dataclass
from typing import Any

import psutil

from weingarten.bench.contender import Contender, Scan
from weingarten.bench.parts import Part
from weingarten.bench.store import Entry, Store, make_folder
from weingarten.device import chosen_device
from weingarten.errors import WeingartenError
from weingarten.fit.run_folder import opened
from weingarten.mesh import Mesh
from weingarten.metrics.protocol import EXACT, FIELD, PUBLISHED
from weingarten.world_field import WorldField

DONE, FAILED = "done", "failed"


@dataclass(frozen=True)
class Job:
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


def perform(job: Job) -> None:
    """Make the mesh, unless it is there; judge it, unless that was done. What goes wrong is noted."""
    make_folder(job.entry.folder)
    if job.entry.fit.get("status") != DONE:
        job.entry.write_fit(fitted(job))
    if job.entry.fit["status"] == DONE and not judged(job):
        job.entry.write_figures(figures(job))


def judged(job: Job) -> bool:
    """Whether a fit has its figures, by today's protocols; those of a field only where it left one."""
    found = job.entry.figures
    return "error" not in found and PUBLISHED.name in found and EXACT.name in found


def fitted(job: Job) -> dict[str, Any]:
    """How the mesh was made: seconds, from points in memory to the mesh; or why there is none."""
    record: dict[str, Any] = {**job.identity, "truth": str(job.part.truth.resolve()), "device": job.device}
    record |= job.origin
    process = psutil.Process()
    try:
        truth = job.part.mesh()
        keep_ceiling(job, truth)
        points = job.store.scan(job.part, job.points, job.seed)
        shown = truth if job.contender.oracle else None
        before, started = process.cpu_times(), time.perf_counter()
        made = job.contender.make(Scan(points, job.seed, job.device, job.entry.folder, shown))
    except Exception as error:
        return record | failure(error)
    after = process.cpu_times()
    return record | {
        "status": DONE,
        "seconds": made.earlier + time.perf_counter() - started,
        "cpu_seconds": (after.user + after.system) - (before.user + before.system),
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


def figures(job: Job) -> dict[str, Any]:
    """Of the mesh, and of the field where there is one, by protocol; or why there are none."""
    try:
        truth, mesh = job.part.mesh(), job.entry.mesh()
        keep_ceiling(job, truth)
        found = [PUBLISHED.evaluate(mesh, truth), EXACT.evaluate(mesh, truth)]
        if job.contender.leaves_field:
            checkpoint, _ = opened(job.entry.folder)
            found.append(FIELD.evaluate(WorldField.of(checkpoint, chosen_device("cpu")), truth))
    except Exception as error:
        return failure(error)
    return {one.protocol: one.as_dict() for one in found}


def fingerprint(part: Part) -> str:
    """Of the truth's file."""
    return hashlib.sha256(part.truth.read_bytes()).hexdigest()


def failure(error: Exception) -> dict[str, Any]:
    """What is noted of a fit that failed: the sentence, and where it was raised unless a user can mend it."""
    if isinstance(error, WeingartenError):
        return {"status": FAILED, "error": str(error)}
    trace = "".join(traceback.format_exception(error))
    return {"status": FAILED, "error": f"{type(error).__name__}: {error}", "traceback": trace}

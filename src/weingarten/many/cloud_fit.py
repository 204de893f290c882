"""One of many clouds, from its file to a run folder that holds its mesh.

OUT/NAME/mesh.ply     beside all else that a run folder holds
         fit.json     which cloud, with which settings; whether it is done, or why it failed
         log.txt      what happened
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import psutil

from weingarten.errors import OptionError
from weingarten.fit.run_folder import RunFolder
from weingarten.io.points import read_points
from weingarten.many.going_on import gone_on
from weingarten.many.job import DONE, FAILED, Job, failure, files_in
from weingarten.many.log import Log
from weingarten.many.records import make_folder, read, write
from weingarten.report.picture import write_picture
from weingarten.report.provenance import machine
from weingarten.settings import Settings

BEGUN = "begun"


@dataclass(frozen=True)
class CloudFit(Job):
    """The fit of a cloud. label: its name within `out`. size: of the file in bytes. picture: a file's name.

    asked: cloud, mesh and command of this fit alone, as who asked for it sees them, for the run folder's
    record. origin: where it is done, for every record: machine, version, commit, date.
    """

    out: Path
    label: str
    cloud: Path
    size: int
    settings: Settings
    device: str
    asked: dict[str, str]
    origin: dict[str, str]
    picture: str | None = None

    @property
    def name(self) -> str:
        """See Job."""
        return self.label

    @property
    def kind(self) -> str:
        """See Job: all are of one."""
        return ""

    @property
    def root(self) -> Path:
        """See Job."""
        return self.out

    @property
    def folder(self) -> Path:
        """See Job."""
        return self.out / self.label

    @property
    def error(self) -> str:
        """See Job."""
        return self.record.get("error", "")

    @property
    def record(self) -> dict[str, Any]:
        """What is noted of it; empty before it was begun. Raises InputError."""
        return read(self.folder / "fit.json")

    @property
    def identity(self) -> dict[str, Any]:
        """What a record must agree in, to be this fit's."""
        return {"cloud": self.cloud.name, "bytes": self.size, "settings": self.settings.as_dict()}

    def done(self, retry: bool) -> bool:
        """Whether there is nothing to do. retry: what failed is tried again, and of other settings always.

        Raises OptionError where its place holds another fit, finished or not.
        """
        found = self.record
        others = [key for key, value in self.identity.items() if found and found.get(key) != value]
        status = found.get("status")
        if others and status != FAILED:
            raise OptionError(
                f"{self.folder} holds a fit with other {others[0]}; choose another -o, or delete the folder."
            )
        return status == DONE or (status == FAILED and not (retry or bool(others)))

    @classmethod
    def perform(cls, batch: Sequence["CloudFit"]) -> None:
        """See Job."""
        for job in batch:
            if job.record.get("status") != DONE:
                job.make()

    def make(self) -> None:
        """Fit, and note what came of it."""
        make_folder(self.folder)
        self.note({"status": BEGUN})
        with Log(self.folder / "log.txt") as log:
            log.say(f"{self.cloud}, on {self.device}.")
            try:
                outcome = self.made(log)
            except Exception as error:
                outcome = failure(error)
                log.say(f"Failed: {outcome.get('traceback') or outcome['error']}")
        self.note(outcome)

    def made(self, log: Log) -> dict[str, Any]:
        """Make mesh and summary; what is noted, processor time since this began. Raises a WeingartenError."""
        process, started = psutil.Process(), time.perf_counter()
        before = process.cpu_times()
        points = read_points(self.cloud)
        keeper = RunFolder(self.folder, {**self.asked, "device": self.device, **self.origin})
        result, earlier = gone_on(points, self.settings, self.device, keeper, observer=log)
        if self.picture is not None:
            write_picture(self.folder / self.picture, points, result.mesh)
        wall, after = time.perf_counter() - started, process.cpu_times()
        return {
            "status": DONE,
            "seconds": earlier + wall,
            "cpu_seconds": after.user + after.system - before.user - before.system,
            "resumed": earlier > 0,
        }

    def note(self, outcome: dict[str, Any]) -> None:
        """Keep what there is to say."""
        said = {**self.identity, "device": self.device, **self.origin, **outcome}
        write(self.folder / "fit.json", said)

    def note_failure(self, failed: dict[str, Any]) -> None:
        """See Job."""
        make_folder(self.folder)
        if self.record.get("status") != DONE:
            with Log(self.folder / "log.txt") as log:
                log.say(f"Failed: {failed['error']}")
            self.note(failed)

    def sources(self) -> list[Path]:
        """See Job."""
        return [self.cloud]

    def kept(self) -> list[Path]:
        """See Job."""
        return files_in(self.folder)

    def moved(self, root: Path, sources: Path) -> "CloudFit":
        """See Job."""
        origin = {**self.origin, "machine": machine()}
        return replace(self, out=root, cloud=sources / self.cloud.name, origin=origin)

"""Jobs without a fit, importable from any process: what they do is in their names."""

import os
import signal
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import torch

from weingarten.errors import FitError
from weingarten.many.job import DONE, Job, failure, files_in
from weingarten.many.records import make_folder, read, write
from weingarten.many.runner import Watcher


@dataclass(frozen=True)
class Errand(Job):
    """ "die": its process is killed. "fail": it fails. "slow": waits for others. source: a file to copy."""

    place: Path
    label: str
    source: Path | None = None

    @property
    def name(self) -> str:
        return self.label

    @property
    def kind(self) -> str:
        return ""

    @property
    def root(self) -> Path:
        return self.place

    @property
    def folder(self) -> Path:
        return self.place / self.label

    @property
    def record(self) -> dict[str, Any]:
        return read(self.folder / "fit.json")

    @property
    def error(self) -> str:
        return self.record.get("error", "")

    @classmethod
    def perform(cls, batch: Sequence["Errand"]) -> None:
        for job in batch:
            job.make()

    def make(self) -> None:
        make_folder(self.folder)
        if self.label == "die":
            time.sleep(0.2)
            os.kill(os.getpid(), signal.SIGKILL)
        if self.label == "slow":
            time.sleep(1.0)
        if self.label == "raise":
            raise ValueError("unforeseen")
        if self.label == "fail":
            return self.note_failure(failure(FitError(f"{self.source} is too hard.")))
        if self.source is not None:
            (self.folder / "copy.bin").write_bytes(self.source.read_bytes())
        with (self.folder / "calls").open("a") as stream:
            stream.write(f"{os.getpid()}\n")
        write(self.folder / "fit.json", {"status": DONE, "threads": torch.get_num_threads()})

    def note_failure(self, failed: dict[str, Any]) -> None:
        make_folder(self.folder)
        write(self.folder / "fit.json", failed)

    def sources(self) -> list[Path]:
        return [] if self.source is None else [self.source]

    def kept(self) -> list[Path]:
        return files_in(self.folder)

    def moved(self, root: Path, sources: Path) -> "Errand":
        source = None if self.source is None else sources / self.source.name
        return replace(self, place=root, source=source)


class Diary(Watcher):
    """Remembers what it was told."""

    def __init__(self) -> None:
        self.begun: list[str] = []
        self.ended: list[str] = []
        self.notes: list[str] = []

    def begin(self, batch: Sequence[Job]) -> None:
        self.begun += [job.name for job in batch]

    def end(self, batch: Sequence[Job]) -> None:
        self.ended += [job.name for job in batch]

    def note(self, text: str) -> None:
        self.notes.append(text)

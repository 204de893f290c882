"""A piece of work whose place is a folder: where it lies, whether it failed, what a machine needs for it."""

import traceback
from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from weingarten.errors import WeingartenError

DONE, FAILED = "done", "failed"


class Job(ABC):
    """One fit. It can be pickled; what it leaves behind lies under `root`, most of it in its own folder."""

    @property
    @abstractmethod
    def name(self) -> str:
        """What a person calls it."""

    @property
    @abstractmethod
    def kind(self) -> str:
        """Jobs of one kind take about as long as each other."""

    @property
    @abstractmethod
    def root(self) -> Path:
        """The folder of all jobs."""

    @property
    @abstractmethod
    def folder(self) -> Path:
        """Its own, within `root`; no other job has it."""

    @property
    @abstractmethod
    def error(self) -> str:
        """Why it failed, in a sentence; the empty string where all is well or nothing was tried yet."""

    @property
    def curve(self) -> Path:
        """Where its loss curve is written; not every job has one."""
        return self.folder / "loss.csv"

    @classmethod
    @abstractmethod
    def perform(cls, batch: Sequence[Any]) -> None:
        """Do all of a batch in this process, except what is done. What goes wrong is noted in the folders."""

    @abstractmethod
    def note_failure(self, failed: dict[str, Any]) -> None:
        """Note of whatever it had not finished that it failed: a `failure`. What was finished stays."""

    @abstractmethod
    def sources(self) -> list[Path]:
        """The files outside of `root` that it reads, of different names."""

    @abstractmethod
    def kept(self) -> list[Path]:
        """The files under `root` that it may go on from, those that there are."""

    @abstractmethod
    def moved(self, root: Path, sources: Path) -> "Job":
        """The same job on a machine where these folders hold what was under `root`, and its sources."""


def failure(error: Exception) -> dict[str, Any]:
    """What is noted of a job that failed: the sentence, and where it was raised unless a user can mend it."""
    if isinstance(error, WeingartenError):
        return {"status": FAILED, "error": str(error)}
    trace = "".join(traceback.format_exception(error))
    return {"status": FAILED, "error": f"{type(error).__name__}: {error}", "traceback": trace}


def files_in(folder: Path) -> list[Path]:
    """All files within a folder and its folders, in order, but those that are being written."""
    found = sorted(folder.rglob("*")) if folder.is_dir() else []
    return [path for path in found if path.is_file() and not path.name.startswith(".")]

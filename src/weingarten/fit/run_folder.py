"""The folder of one fit: config.toml, loss.csv, checkpoint.safetensors, cloud.npy, history/, mesh.ply,
summary.json, and made.json, the record of who made it how.

There is a summary of a fit that has ended, and of no other. While a fit is written there, a file `lock` says
by whom. A fit without a folder uses `NoFolder`, so that nothing asks whether there is one.
"""

import csv
import json
import math
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
import tomli_w
from jaxtyping import Float64

from weingarten.atomic import remove_leftovers, replacing
from weingarten.errors import CheckpointError, InputError, OutputError
from weingarten.fit import checkpoint
from weingarten.fit.checkpoint import Checkpoint, Origin
from weingarten.fit.history import SNAPSHOTS, History
from weingarten.fit.lock import held
from weingarten.fit.loop import Loop, Record
from weingarten.io.mesh import write_mesh
from weingarten.io.points import read_points
from weingarten.io.reading import reading
from weingarten.mesh import Mesh
from weingarten.summary import Summary

Points = Float64[np.ndarray, "n 3"]

PRIMITIVES, LABELS, MADE = "primitives.json", "labels.npy", "made.json"
RESULTS = ("mesh.ply", "summary.json", PRIMITIVES, LABELS, MADE)


@runtime_checkable
class Keeper(Protocol):
    """Whoever keeps what a fit leaves behind."""

    def held(self) -> AbstractContextManager[None]:
        """Entered before all else and left when all is done; OutputError where another fit is being kept."""
        ...

    def found(self) -> Checkpoint:
        """The checkpoint to go on from; CheckpointError where there is none."""
        ...

    def begin(self, origin: Origin, points: Points, resumed: Checkpoint | None) -> None:
        """Write what is known before the first step."""
        ...

    def record(self, record: Record, seconds: float) -> None:
        """Note one step."""
        ...

    def look(self, loop: Loop) -> None:
        """See the field before each step, before each `save` and after the last step."""
        ...

    def save(self, loop: Loop, origin: Origin, tensors: dict, extra: dict) -> None:
        """Keep the state of the fit."""
        ...

    def finish(self, mesh: Mesh, summary: Summary) -> None:
        """Keep the result, world frame."""
        ...


class NoFolder:
    """Keeps nothing."""

    def held(self) -> AbstractContextManager[None]:
        """See Keeper."""
        return nullcontext()

    def found(self) -> Checkpoint:
        """There is none."""
        raise CheckpointError("A fit without a run folder cannot be resumed; name its folder.")

    def begin(self, origin: Origin, points: Points, resumed: Checkpoint | None) -> None:
        """See Keeper."""

    def record(self, record: Record, seconds: float) -> None:
        """See Keeper."""

    def look(self, loop: Loop) -> None:
        """See Keeper."""

    def save(self, loop: Loop, origin: Origin, tensors: dict, extra: dict) -> None:
        """See Keeper."""

    def finish(self, mesh: Mesh, summary: Summary) -> None:
        """See Keeper."""


EARLIER = ("checkpoint.safetensors", *RESULTS)
"""What a fit leaves behind that another one must not be taken for."""
FILES = (*EARLIER, "config.toml", "cloud.npy", "loss.csv")


class RunFolder:
    """Keeps everything in a folder, made if need be. Raises OutputError where that cannot be.

    made: a record of the command, the machine and so on, if there is one. snapshots: how many of the field on
    its way (`weingarten.fit.history`).
    """

    def __init__(self, path: Path, made: dict[str, str] | None = None, snapshots: int = SNAPSHOTS) -> None:
        self.path, self.made = path, made
        self.history = History(path, snapshots)
        self.rows: list[list[str]] = []
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"The run folder {path} cannot be made: {error.strerror}.") from error

    def held(self) -> AbstractContextManager[None]:
        """See Keeper: no other process writes here."""
        return held(self.path)

    def keep(self) -> Path | None:
        """The folder, if a fit can go on from there."""
        return self.path if self.checkpoint.is_file() else None

    @property
    def checkpoint(self) -> Path:
        """Where the state of the fit is."""
        return self.path / "checkpoint.safetensors"

    def found(self) -> Checkpoint:
        """The checkpoint in the folder; CheckpointError where there is none or it cannot be read."""
        return checkpoint.load(self.checkpoint)

    @property
    def cloud(self) -> Path:
        """Where the cleaned points are, world units."""
        return self.path / "cloud.npy"

    @property
    def curve(self) -> Path:
        """Where the loss curve is."""
        return self.path / "loss.csv"

    @property
    def summary(self) -> Path:
        """Where the figures are."""
        return self.path / "summary.json"

    def begin(self, origin: Origin, points: Points, resumed: Checkpoint | None) -> None:
        """Write what is known before the first step; keep curve and snapshots up to a resumed checkpoint.

        What the folder holds of an earlier fit goes first, its checkpoint before all else: whenever the
        process dies, the folder holds one fit or none.
        """
        remove_leftovers(self.path, FILES)
        for name in ("summary.json",) if resumed else EARLIER:
            (self.path / name).unlink(missing_ok=True)
        self.history.begin(None if resumed is None else resumed.step)
        with replacing(self.path / "config.toml") as temporary:
            temporary.write_bytes(tomli_w.dumps(origin.settings.as_dict()).encode())
        if self.made is not None:
            with replacing(self.path / MADE) as temporary:
                temporary.write_text(json.dumps(self.made, indent=2) + "\n")
        if resumed is None or not self.cloud.is_file():
            with replacing(self.cloud) as temporary, temporary.open("wb") as stream:
                np.save(stream, points, allow_pickle=False)
        kept = [] if resumed is None else self.curve_until(resumed.step)
        with replacing(self.curve) as temporary, temporary.open("w", newline="") as stream:
            csv.writer(stream).writerows(kept)

    def curve_until(self, step: int) -> list[list[str]]:
        """The head of the loss curve and its rows before `step`; nothing before 0, whose row brings a head.

        Raises CheckpointError where it cannot be read.
        """
        if step == 0 or not self.curve.is_file():
            return []
        with (
            reading(self.curve, CheckpointError, "a loss curve", "delete it, and resume without it"),
            self.curve.open(newline="", encoding="utf-8") as stream,
        ):
            return [row for row in csv.reader(stream) if row[:1] == ["step"] or before(row, step)]

    def record(self, record: Record, seconds: float) -> None:
        """Note one step; it reaches the file with the next checkpoint."""
        names = list(record.terms)
        if record.step == 0:
            header = ["step", "progress", "rate", "loss", "seconds"]
            self.rows.append([*header, *names, *(f"weight_{name}" for name in names)])
        values = [record.progress, record.rate, record.loss, seconds, *record.terms.values()]
        values += [record.weights[name] for name in names]
        self.rows.append([str(record.step), *(f"{value:.9g}" for value in values)])

    def look(self, loop: Loop) -> None:
        """Keep a snapshot of the field where one is due."""
        self.history.look(loop)

    def save(self, loop: Loop, origin: Origin, tensors: dict, extra: dict) -> None:
        """Write the checkpoint and the loss curve up to it."""
        try:
            with self.curve.open("a", newline="") as stream:
                csv.writer(stream).writerows(self.rows)
        except OSError as error:
            raise OutputError(f"{self.curve} could not be written: {error.strerror}.") from error
        self.rows.clear()
        checkpoint.save(self.checkpoint, loop, origin, tensors, extra)

    def finish(self, mesh: Mesh, summary: Summary) -> None:
        """Write the mesh and the figures; what was measured on an earlier mesh goes."""
        for name in (PRIMITIVES, LABELS):
            (self.path / name).unlink(missing_ok=True)
        write_mesh(self.path / "mesh.ply", mesh)
        with replacing(self.summary) as temporary:
            temporary.write_text(json.dumps(summary.as_dict(), indent=2) + "\n")


def opened(path: Path) -> tuple[Checkpoint, Points]:
    """Checkpoint and cloud (world units) of a run folder, for reading; CheckpointError if unreadable."""
    if not path.is_dir():
        raise CheckpointError(
            f"There is no run folder at {path}; make one with `weingarten fit --run {path}`."
        )
    found = checkpoint.load(path / "checkpoint.safetensors")
    try:
        points = read_points(path / "cloud.npy")
    except InputError as error:
        cause = str(error).rstrip(".")
        raise CheckpointError(f"The cloud of this run is damaged: {cause}, or run the fit again.") from error
    if checkpoint.fingerprint(points) != found.origin.fingerprint:
        raise CheckpointError(f"{path / 'cloud.npy'} is not the cloud of this run; run the fit again.")
    return found, points


def before(row: list[str], step: int) -> bool:
    """Whether a row of the loss curve is whole and of an earlier step."""
    try:
        return len(row) > 5 and int(row[0]) < step and not math.isnan(float(row[4]))
    except ValueError:
        return False

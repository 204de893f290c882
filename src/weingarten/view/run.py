"""A run folder that is looked at, perhaps while a fit writes to it: what is read may be replaced."""

import hashlib
import json
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch

from weingarten.crew import crew_for
from weingarten.errors import CheckpointError, InputError, WeingartenError
from weingarten.fit import checkpoint, history
from weingarten.fit.checkpoint import Checkpoint
from weingarten.fit.curve import Columns, read_curve
from weingarten.fit.run_folder import PRIMITIVES, opened
from weingarten.frame import Frame
from weingarten.io.mesh import read_mesh
from weingarten.mesh import Mesh
from weingarten.surface.contour import extraction
from weingarten.surface.values import BATCH, field_values
from weingarten.view.primitives import primitives_in
from weingarten.view.section import Box
from weingarten.view.status import RUNNING, Status, status
from weingarten.view.subject import Cloud, Look, Surface
from weingarten.world_field import WorldField

RESOLUTION = 96
"""Cells along the longest side, of surfaces on the way."""

LAST = 25
"""Steps whose time tells that of those to come."""

DEVICE = torch.device("cpu")
"""A fit on another device is left alone."""

Mark = tuple[int, int, int]
"""What tells a file from the one that it replaced."""


@dataclass
class Run:
    """A run folder. found, cloud: as last read. box: see Subject; None where the network is the user's own.

    Raises CheckpointError where there is no run.
    """

    path: Path
    found: Checkpoint = field(init=False)
    cloud: Cloud = field(init=False)
    box: Box | None = field(init=False)
    read: Mark = field(init=False)

    def __post_init__(self) -> None:
        self.name = self.path.resolve().name
        self.begin()

    def begin(self) -> None:
        """Read everything anew."""
        now = mark(self.checkpoint)
        self.found, points = opened(self.path)
        self.cloud, self.box, self.read = Cloud.of(points), box_of(self.found), now

    @property
    def checkpoint(self) -> Path:
        """Where the state of the fit is."""
        return self.path / "checkpoint.safetensors"

    @property
    def frame(self) -> Frame:
        """See Subject."""
        return self.found.origin.frame

    def look(self) -> Look:
        """See Subject."""
        try:
            self.catch_up()
            curve = read_curve(self.path / "loss.csv")
        except (WeingartenError, OSError) as error:
            return Look(self.version, status=Status(RUNNING, 0, 0, f"{error}"))
        summary, mesh = self.summary(), self.path / "mesh.ply"
        of, step = self.found.origin.settings.steps, self.found.step
        ended = bool(summary) and summary.get("steps") == step
        silent = max(0.0, time.time() - self.read[0] / 1e9)
        return Look(
            version=self.version,
            final=":".join(map(str, (*mark(mesh), *mark(self.path / PRIMITIVES))))
            if ended and mesh.is_file()
            else "",
            steps=tuple(history.steps_kept(self.path / history.FOLDER)) if self.box is not None else (),
            status=status(step, of, ended, silent, each(curve)),
            curve=curve,
            facts=facts(summary) if ended else (),
        )

    @property
    def version(self) -> str:
        """See Look: of the cloud and the settings, which make the fit what it is."""
        origin = self.found.origin
        said = json.dumps([origin.fingerprint, origin.settings.as_dict()], sort_keys=True)
        return hashlib.sha256(said.encode()).hexdigest()[:16]

    def catch_up(self) -> None:
        """Read the checkpoint if it is another one. Raises CheckpointError."""
        now = mark(self.checkpoint)
        if now == self.read:
            return
        found = checkpoint.load(self.checkpoint)
        if found.origin.fingerprint != self.found.origin.fingerprint:
            self.begin()
        else:
            self.found, self.box, self.read = found, box_of(found), now

    def summary(self) -> dict[str, Any]:
        """The figures of a fit that has ended; empty of one that has not."""
        try:
            said = json.loads((self.path / "summary.json").read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError):
            return {}
        return said if isinstance(said, dict) else {}

    def surface(self, step: int | None) -> Surface:
        """See Subject. That of a step is a coarse one, ghosts and all."""
        found = self.found
        origin = found.origin
        if step is None:
            mesh = read_mesh(self.path / "mesh.ply")
            known = None if self.box is None else WorldField.of(found, DEVICE)
            return Surface(mesh, known, primitives_in(self.path, mesh))
        module = origin.settings.field()
        try:
            module.load_state_dict(history.weights(self.path / history.FOLDER, step))
        except RuntimeError as error:
            raise InputError(f"The snapshot of step {step} is of another network.") from error
        values = field_values(module, crew_for(DEVICE))
        lower, upper = np.array(origin.lower), np.array(origin.upper)
        mesh = extraction(values, lower, upper, RESOLUTION, BATCH, crew_for(DEVICE)).mesh
        return Surface(
            Mesh(origin.frame.to_world(mesh.vertices), mesh.faces), WorldField(module, origin.frame)
        )


def box_of(found: Checkpoint) -> Box | None:
    """The box of a run's surface; None where its network is not that of its settings."""
    try:
        WorldField.of(found, DEVICE)
    except CheckpointError:
        return None
    origin = found.origin
    lower, upper = origin.frame.to_world(np.array([origin.lower, origin.upper]))
    return Box(lower, upper)


def mark(path: Path) -> Mark:
    """When a file was written, its size and its number; zeros without it."""
    try:
        found = path.stat()
    except OSError:
        return 0, 0, 0
    return found.st_mtime_ns, found.st_size, found.st_ino


def each(curve: Columns) -> float:
    """Seconds a step, of the last ones; 0 where none is known."""
    seconds = curve.get("seconds", np.empty(0))[-LAST:]
    known = seconds[np.isfinite(seconds)]
    return float(known.mean()) if len(known) else 0.0


def facts(summary: dict[str, Any]) -> tuple[str, ...]:
    """What a summary says, in sentences: the mesh, its distance to the points, what speaks against it."""
    found: tuple[str, ...] = ()
    if isinstance(summary.get("watertight"), bool):
        found += ("Watertight." if summary["watertight"] else "Not watertight.",)
    mean, most = summary.get("distance_mean"), summary.get("distance_p95")
    if isinstance(mean, float) and isinstance(most, float):
        found += (f"Points to mesh: mean {mean:.3g}, 95 % within {most:.3g}.",)
    doubts = summary.get("doubts", [])
    return found + tuple(str(doubt) for doubt in doubts if isinstance(doubt, str))

"""Who takes part in a benchmark: anything that makes a mesh of points, and says what it is.

A contender sees points alone. The one exception says so in its name: the oracle, which is shown the truth to
know when to stop, as the paper's tables were made.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from weingarten.bench.poisson import NEIGHBOURS, SCREENING, screened_poisson, solver
from weingarten.fit.run_folder import RunFolder
from weingarten.io.mesh import write_mesh
from weingarten.many.going_on import gone_on
from weingarten.mesh import Mesh
from weingarten.reconstruction import Result
from weingarten.scan.sampling import Points
from weingarten.settings import Settings
from weingarten.together import reconstruct_many
from weingarten.world_field import WorldField

ORACLE = "+oracle"
POISSON = "poisson"


@dataclass(frozen=True)
class Scan:
    """What a contender is given: points in world units, a seed, a device and a folder.

    folder: for its mesh.ply, and what else it keeps. truth: None but for an oracle.
    """

    points: Points
    seed: int
    device: str
    folder: Path
    truth: Mesh | None = None


@dataclass(frozen=True)
class Made:
    """What is to be said of a mesh that was made.

    earlier: seconds spent on it before an interruption. phases: seconds by phase. field: where there is one
    that the folder does not hold.
    """

    notes: tuple[str, ...] = ()
    phases: dict[str, float] | None = None
    earlier: float = 0.0
    field: WorldField | None = None


class Contender(ABC):
    """Whoever takes part. oracle: whether it is shown the truth."""

    oracle: bool = False

    @property
    @abstractmethod
    def name(self) -> str:
        """Unique within a benchmark, and the name of a folder."""

    @abstractmethod
    def description(self) -> dict[str, Any]:
        """All that determines its mesh beside scan, seed and device, as plain values."""

    @abstractmethod
    def make(self, scan: Scan) -> Made:
        """Write the scan's mesh to mesh.ply in its folder. Raises a WeingartenError where there is none."""

    def make_all(self, scans: Sequence[Scan]) -> list[Made | Exception]:
        """The same of many scans of one seed; the error where there is none."""
        return [attempt(self.make, scan) for scan in scans]


@dataclass(frozen=True)
class Neural(Contender):
    """One method under one schedule. settings: of any seed; the scan's is taken."""

    label: str
    settings: Settings
    oracle: bool = False

    @property
    def name(self) -> str:
        """The label, marked when it is an oracle's."""
        return self.label + ORACLE if self.oracle else self.label

    def description(self) -> dict[str, Any]:
        """See Contender."""
        settings = self.settings.as_dict()
        del settings["seed"]
        return {"kind": "neural", "oracle": self.oracle, **settings}

    def make(self, scan: Scan) -> Made:
        """See Contender. Goes on from the folder's checkpoint where there is one of the same fit."""
        settings, folder = replace(self.settings, seed=scan.seed), RunFolder(scan.folder, snapshots=0)
        result, earlier = gone_on(scan.points, settings, scan.device, folder, scan.truth)
        return Made(result.summary.notes, result.summary.seconds, earlier)

    def make_all(self, scans: Sequence[Scan]) -> list[Made | Exception]:
        """See Contender. Many are fitted as one ensemble, which cannot be resumed; an oracle's are not."""
        if len(scans) == 1 or self.oracle:
            return super().make_all(scans)
        first = scans[0]
        settings = replace(self.settings, seed=first.seed)
        found = reconstruct_many([scan.points for scan in scans], settings, device=first.device)
        return [
            answer if isinstance(answer, Exception) else self.kept(answer, scan)
            for answer, scan in zip(found, scans, strict=True)
        ]

    def kept(self, result: Result, scan: Scan) -> Made:
        """A result of an ensemble: its mesh goes to the folder, its field to whoever judges."""
        write_mesh(scan.folder / "mesh.ply", result.mesh)
        return Made(result.summary.notes, result.summary.seconds, field=result.field)


@dataclass(frozen=True)
class Poisson(Contender):
    """Screened Poisson reconstruction from estimated normals: what a practitioner does today."""

    depth: int = 8

    @property
    def name(self) -> str:
        """See Contender."""
        return POISSON

    def description(self) -> dict[str, Any]:
        """See Contender."""
        fixed = {"neighbours": NEIGHBOURS, "screening": SCREENING, "solver": solver()}
        return {"kind": "poisson", "depth": self.depth, **fixed}

    def make(self, scan: Scan) -> Made:
        """See Contender."""
        write_mesh(scan.folder / "mesh.ply", screened_poisson(scan.points, self.depth))
        return Made()


def attempt(make: Callable[[Scan], Made], scan: Scan) -> Made | Exception:
    """What was made, or the error."""
    try:
        return make(scan)
    except Exception as error:
        return error

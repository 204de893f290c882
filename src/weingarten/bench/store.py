"""The folder of a benchmark: where every fit lies, what is known of it, and whether it is done.

    DIR/clouds/PART/seed0.npy                 the scan that every contender of this part and seed was given
    DIR/fits/PART/CONTENDER/seed0/mesh.ply    its mesh, beside all else that a run folder holds
                                  fit.json    how it was made, or why it failed; written last
                                  figures.json    how far it is from the truth, by protocol
    DIR/truths/PART.json                      which file the truth is, and what it scores against itself

Whatever has its file is done and is never made again.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from weingarten.atomic import replacing
from weingarten.bench.parts import Part
from weingarten.errors import OutputError
from weingarten.io.mesh import read_mesh
from weingarten.io.points import read_points
from weingarten.io.reading import check_readable, reading
from weingarten.mesh import Mesh
from weingarten.scan.sampling import Points


@dataclass(frozen=True)
class Entry:
    """One fit's place in a benchmark, and what is known of it."""

    folder: Path

    @property
    def mesh_path(self) -> Path:
        """Where its mesh is."""
        return self.folder / "mesh.ply"

    @property
    def curve_path(self) -> Path:
        """Where its loss curve is; not every contender has one."""
        return self.folder / "loss.csv"

    @property
    def checkpoint_path(self) -> Path:
        """Where its field is; not every contender leaves one."""
        return self.folder / "checkpoint.safetensors"

    def mesh(self) -> Mesh:
        """What was made, world frame. Raises InputError."""
        return read_mesh(self.mesh_path)

    @property
    def fit(self) -> dict[str, Any]:
        """How it was made; empty while it was not."""
        return read(self.folder / "fit.json")

    @property
    def figures(self) -> dict[str, Any]:
        """By protocol; empty while there are none."""
        return read(self.folder / "figures.json")

    @property
    def error(self) -> str:
        """Why there is no mesh, or no figure of it; empty where all is well or nothing was tried yet."""
        return self.fit.get("error") or self.figures.get("error") or ""

    def write_fit(self, values: dict[str, Any]) -> None:
        """Note that it was made, or that it failed."""
        write(self.folder / "fit.json", values)

    def write_figures(self, values: dict[str, Any]) -> None:
        """Note how good it is."""
        write(self.folder / "figures.json", values)


@dataclass(frozen=True)
class Store:
    """A benchmark's folder."""

    path: Path

    def entry(self, part: str, contender: str, seed: int) -> Entry:
        """The place of one fit."""
        return Entry(self.path / "fits" / part / contender / f"seed{seed}")

    def entries(self) -> list[Entry]:
        """Of all fits that were begun, by part, contender and seed."""
        return [Entry(path) for path in sorted((self.path / "fits").glob("*/*/seed*")) if path.is_dir()]

    def scan(self, part: Part, count: int, seed: int) -> Points:
        """The points that all contenders get, world frame; kept the first time."""
        path = self.path / "clouds" / part.name / f"seed{seed}.npy"
        if path.exists():
            return read_points(path)
        points = part.scan(count, seed)
        make_folder(path.parent)
        with replacing(path) as temporary, temporary.open("wb") as stream:
            np.save(stream, points, allow_pickle=False)
        return points

    def truth(self, part: str) -> dict[str, Any]:
        """What is known of a part's truth; empty while nothing is."""
        return read(self.path / "truths" / f"{part}.json")

    def write_truth(self, part: str, values: dict[str, Any]) -> None:
        """Note what is known of a truth."""
        make_folder(self.path / "truths")
        write(self.path / "truths" / f"{part}.json", values)


def make_folder(path: Path) -> None:
    """Raise OutputError where it cannot be made."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"The folder {path} cannot be made: {error.strerror}.") from error


def read(path: Path) -> dict[str, Any]:
    """A JSON object; empty where there is no file. Raises InputError for anything else."""
    if not path.exists():
        return {}
    check_readable(path, [".json"])
    with reading(path, remedy="delete it, and it is made again"):
        values = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(values, dict):
            raise ValueError("it holds no object")
        return values


def write(path: Path, values: dict[str, Any]) -> None:
    """Write a JSON object, whole or not at all. ValueError for NaN and infinities."""
    text = json.dumps(values, indent=1, allow_nan=False)
    with replacing(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")

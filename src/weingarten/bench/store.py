"""The folder of a benchmark: where every fit lies, what is known of it, and whether it is done.

    DIR/clouds/PART/seed0.npy                 the scan that every contender of this part and seed was given
    DIR/fits/PART/CONTENDER/seed0/mesh.ply    its mesh, beside all else that a run folder holds
                                  fit.json    how it was made, or why it failed; written last
                                  figures.json    how far it is from the truth, by protocol
    DIR/truths/PART.json                      which file the truth is, and what it scores against itself

Whatever has its file is done and is never made again.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from weingarten.atomic import replacing
from weingarten.bench.parts import Part
from weingarten.io.mesh import read_mesh
from weingarten.io.points import read_points
from weingarten.many.records import make_folder, read, write
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
        path = self.scan_path(part, seed)
        if path.exists():
            return read_points(path)
        points = part.scan(count, seed)
        make_folder(path.parent)
        with replacing(path) as temporary, temporary.open("wb") as stream:
            np.save(stream, points, allow_pickle=False)
        return points

    def scan_path(self, part: Part, seed: int) -> Path:
        """Where the points that all contenders get are kept."""
        return self.path / "clouds" / part.name / f"seed{seed}.npy"

    def truth_path(self, part: str) -> Path:
        """Where it is kept what is known of a part's truth."""
        return self.path / "truths" / f"{part}.json"

    def truth(self, part: str) -> dict[str, Any]:
        """What is known of a part's truth; empty while nothing is."""
        return read(self.truth_path(part))

    def write_truth(self, part: str, values: dict[str, Any]) -> None:
        """Note what is known of a truth."""
        path = self.truth_path(part)
        make_folder(path.parent)
        write(path, values)

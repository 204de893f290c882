"""A run folder as a page reads it: what is there, and None or nothing for what is not."""

import json
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from weingarten.errors import InputError
from weingarten.fit.run_folder import MADE, PRIMITIVES
from weingarten.io.mesh import read_mesh
from weingarten.mesh import Mesh
from weingarten.report.curves import Columns, read_curve

Points = Float64[np.ndarray, "n 3"]

CONFIG = "config.toml"


@dataclass(frozen=True)
class Run:
    """One fit. cloud, mesh: world frame. settings, summary: as they stand in their files.

    mesh, summary: None where the fit ended before its surface was extracted. made: the record of who made it
    how, empty where there is none. losses: the columns of loss.csv. primitives: rows of any keys.
    """

    name: str
    settings: dict[str, Any]
    cloud: Points
    mesh: Mesh | None
    summary: dict[str, Any] | None
    made: dict[str, Any]
    losses: Columns
    primitives: list[dict[str, Any]]

    @property
    def taken(self) -> int:
        """How many steps are known to have been taken."""
        if self.summary is not None and "steps" in self.summary:
            return int(self.summary["steps"])
        return int(self.losses["step"].max()) + 1 if "step" in self.losses else 0

    @property
    def planned(self) -> int:
        """How many steps there were to be."""
        return int(self.settings.get("steps", self.taken))


def read_run(folder: Path) -> Run:
    """What a run folder holds. Raises InputError where a file is missing or cannot be read."""
    mesh, summary = folder / "mesh.ply", folder / "summary.json"
    whole = mesh.exists() and summary.exists()
    made = json_object(folder / MADE) if (folder / MADE).exists() else {}
    rows = json_object(folder / PRIMITIVES).get("primitives") if (folder / PRIMITIVES).exists() else None
    return Run(
        name=Path(str(made.get("cloud") or folder.resolve())).name,
        settings=read_settings(folder / CONFIG),
        cloud=read_cloud(folder / "cloud.npy"),
        mesh=read_mesh(mesh) if whole else None,
        summary=json_object(summary) if whole else None,
        made=made,
        losses=read_curve(folder / "loss.csv"),
        primitives=[row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else [],
    )


def json_object(path: Path) -> dict[str, Any]:
    """The JSON object in a file."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise unreadable(path, error) from error
    if not isinstance(found, dict):
        raise unreadable(path, "it holds no JSON object")
    return found


def read_settings(path: Path) -> dict[str, Any]:
    """The settings of a fit."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise unreadable(path, error) from error


def read_cloud(path: Path) -> Points:
    """The points of a fit."""
    try:
        points = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise unreadable(path, error) from error
    if points.dtype != np.float64 or points.ndim != 2 or points.shape[1] != 3 or not len(points):
        raise unreadable(path, f"its array is {points.dtype}, {points.shape}")
    return points


def unreadable(path: Path, why: object) -> InputError:
    """The error that says so."""
    return InputError(f"{path} cannot be read ({why}); run the fit again.")

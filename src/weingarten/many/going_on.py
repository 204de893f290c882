"""A reconstruction that is kept in a folder, and goes on from what an interruption has left there."""

import csv
import math
from pathlib import Path

from weingarten.errors import CheckpointError
from weingarten.fit.run_folder import RunFolder
from weingarten.io.reading import reading
from weingarten.mesh import Mesh
from weingarten.observer import Observer
from weingarten.reconstruction import Points, Result, reconstruct
from weingarten.settings import Settings


def gone_on(
    points: Points,
    settings: Settings,
    device: str,
    folder: RunFolder,
    truth: Mesh | None = None,
    observer: Observer | None = None,
) -> tuple[Result, float]:
    """The reconstruction, and the seconds that its steps took before this; anew where no checkpoint fits.

    folder: that it is kept in. The others, and what is raised, as in `reconstruct`.
    """

    def fitted(resume: bool) -> Result:
        return reconstruct(
            points,
            settings,
            device=device,
            run_folder=folder,
            resume=resume,
            truth=truth,
            observer=observer,
        )

    if folder.checkpoint.exists():
        earlier = seconds_of(folder.curve)
        try:
            return fitted(resume=True), earlier
        except CheckpointError:
            pass  # damaged, or of other settings or points
    return fitted(resume=False), 0.0


def seconds_of(curve: Path) -> float:
    """Of all steps that a loss curve holds; 0 without one."""
    if not curve.is_file():
        return 0.0
    with (
        reading(curve, kind="a loss curve", remedy="delete it, and it is made again"),
        curve.open(newline="", encoding="utf-8") as stream,
    ):
        return math.fsum(float(row["seconds"]) for row in csv.DictReader(stream) if row.get("seconds"))

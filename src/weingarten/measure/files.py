"""The files of a measurement, in the folder of its run."""

import json
from pathlib import Path

import numpy as np

from weingarten.atomic import replacing
from weingarten.fit.run_folder import LABELS, PRIMITIVES
from weingarten.measure.measurement import Measurement


def write_measurement(folder: Path, found: Measurement) -> None:
    """primitives.json, and labels.npy (int32, one for every vertex of mesh.ply). Raises OutputError."""
    with replacing(folder / LABELS) as temporary, temporary.open("wb") as stream:
        np.save(stream, found.labels, allow_pickle=False)
    write_json(folder / PRIMITIVES, found)


def write_json(path: Path, found: Measurement) -> None:
    """As `Measurement.as_dict`. Raises OutputError."""
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(found.as_dict(), indent=2, allow_nan=False) + "\n")

"""The loss curve that a fit leaves behind, loss.csv, as far as it is written."""

import csv
from pathlib import Path

import numpy as np
from jaxtyping import Float64

Columns = dict[str, Float64[np.ndarray, " _"]]


def read_curve(path: Path) -> Columns:
    """The columns of a loss.csv as far as it is whole; empty without one."""
    if not path.is_file():
        return {}
    try:
        with path.open(newline="", encoding="utf-8") as stream:
            head, *rows = [*csv.reader(stream)] or [[]]
    except (csv.Error, UnicodeDecodeError):
        return {}
    rows = [row for row in rows if len(row) == len(head)]
    if "progress" not in head or not rows:
        return {}
    try:
        values = np.array(rows, dtype=np.float64)
    except ValueError:
        return {}
    return {name: values[:, k] for k, name in enumerate(head)}

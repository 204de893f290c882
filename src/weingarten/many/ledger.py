"""The table of many fits, results.csv and results.json: a row a cloud, kept while they are made."""

import csv
import json
import time
from pathlib import Path
from typing import Any

from weingarten.atomic import replacing
from weingarten.many.records import read
from weingarten.many.runner import Batch, Watcher

SAID = ("cloud", "status", "seconds", "cpu_seconds")
"""What a record says that is in the table."""
MEASURED = (
    "watertight",
    "components",
    "genus",
    "self_intersecting",
    "faces",
    "points",
    "distance_mean",
    "distance_p95",
    "distance_max",
    "diagonal",
    "guessed",
    "missed",
    "doubts",
)
"""Figures of a summary that are in the table; lengths in the cloud's unit."""
SHARE = 0.05
"""Of the time may go into writing the table; that of a million rows is not written after every fit."""

Row = dict[str, Any]


class Ledger(Watcher):
    """Writes the table of a folder when it begins, after the fits, and at its end."""

    def __init__(self, out: Path) -> None:
        self.out = out
        self.rows = rows(out)
        self.rest = 0.0
        self.write()

    def end(self, batch: Batch) -> None:
        """See Watcher."""
        self.rows |= {job.folder.name: row for job in batch if (row := row_of(job.folder))}
        if time.monotonic() >= self.rest:
            self.write()

    def write(self) -> None:
        """Both files, each whole or not at all."""
        started = time.monotonic()
        write_rows(self.out, [self.rows[name] for name in sorted(self.rows)])
        ended = time.monotonic()
        self.rest = ended + (ended - started) / SHARE

    def close(self) -> list[Row]:
        """Write what the folder holds, what others have made meanwhile too; its rows."""
        self.rows = rows(self.out)
        self.write()
        return [self.rows[name] for name in sorted(self.rows)]


def rows(out: Path) -> dict[str, Row]:
    """Of every fit that a folder holds, by name."""
    return {folder.name: row for folder in sorted(out.iterdir()) if (row := row_of(folder))}


def row_of(folder: Path) -> Row:
    """What is known of a fit; empty where there is none. Raises InputError for a damaged record."""
    found = read(folder / "fit.json")
    if not found:
        return {}
    summary = read(folder / "summary.json") if found["status"] == "done" else {}
    measured = {key: summary.get(key) for key in MEASURED}
    said = {key: found.get(key) for key in SAID}
    return {"name": folder.name, **said, **measured, "error": found.get("error", "")}


def write_rows(out: Path, found: list[Row]) -> None:
    """The table as CSV and JSON."""
    head = ["name", *SAID, *MEASURED, "error"]
    with (
        replacing(out / "results.csv") as temporary,
        temporary.open("w", newline="", encoding="utf-8") as stream,
    ):
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(head)
        for row in found:
            writer.writerow([" ".join(row[key] or ()) if key == "doubts" else row[key] for key in head])
    with replacing(out / "results.json") as temporary:
        temporary.write_text(json.dumps(found, indent=1, allow_nan=False) + "\n", encoding="utf-8")

"""All that a benchmark's folder holds, as one list of results, and as CSV and JSON."""

import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from weingarten.atomic import replacing
from weingarten.bench.job import DONE
from weingarten.bench.store import Entry, Store

PENDING = "It has not been judged yet."

Value = float | int | bool | str | None


@dataclass(frozen=True)
class Result:
    """One fit, as far as it is known. values: figures by "PROTOCOL.name", None where one does not exist.

    error: why there is no figure, else the empty string. flags: what is odd about truth and mesh.
    """

    part: str
    contender: str
    seed: int
    error: str
    values: dict[str, Value]
    flags: tuple[str, ...]
    entry: Entry
    fit: dict[str, Any]

    @property
    def seconds(self) -> float | None:
        """From points in memory to the mesh."""
        return self.fit.get("seconds")

    @property
    def good(self) -> bool:
        """Whether there are figures."""
        return not self.error

    @property
    def failed(self) -> bool:
        """Whether there will be none."""
        return self.error not in ("", PENDING)

    def number(self, key: str) -> float | None:
        """A figure as a number, truth values as 0 and 1; None where it does not exist."""
        value = self.values.get(key)
        return None if value is None or isinstance(value, str) else float(value)


def results(store: Store) -> list[Result]:
    """Every fit that was made or has failed, by part, contender and seed; those under way are left out."""
    found = [(entry, entry.fit) for entry in store.entries()]
    return [result(store, entry, fit) for entry, fit in found if fit]


def result(store: Store, entry: Entry, fit: dict[str, Any]) -> Result:
    """One fit's."""
    figures = entry.figures if fit["status"] == DONE else {}
    error = entry.error or ("" if figures else PENDING)
    values: dict[str, Value] = {}
    flags: set[str] = set()
    for protocol, own in figures.items():
        if isinstance(own, dict):
            values |= {f"{protocol}.{name}": own[name] for name in own if name not in ("protocol", "flags")}
            flags |= set(own.get("flags", ()))
    values |= derived(values, store.truth(fit["part"]))
    return Result(fit["part"], fit["contender"], fit["seed"], error, values, tuple(sorted(flags)), entry, fit)


def derived(values: dict[str, Value], truth: dict[str, Any]) -> dict[str, Value]:
    """What follows from the figures: the excess over the ceiling, and whether the topology is right."""
    more: dict[str, Value] = {}
    for name, most in truth.get("ceiling", {}).items():
        more[f"published-1.ceiling_{name}"] = most
    chamfer, least = values.get("published-1.chamfer"), more.get("published-1.ceiling_chamfer")
    if isinstance(chamfer, float) and isinstance(least, float):
        more["published-1.excess_chamfer"] = chamfer - least
    if "exact-1.watertight" in values:
        same = all(
            values[f"exact-1.{name}"] == values[f"exact-1.truth_{name}"] for name in ("components", "genus")
        )
        more["exact-1.topology_right"] = bool(values["exact-1.watertight"]) and same
    return more


def write_results(store: Store, found: Sequence[Result]) -> tuple[Path, Path]:
    """results.csv, a row a fit, and results.json, which also says how each was made; the two paths."""
    rows, whole = store.path / "results.csv", store.path / "results.json"
    keys = list(dict.fromkeys(key for one in found for key in one.values))
    head = ["part", "contender", "seed", "error", "flags", "seconds", "cpu_seconds", "commit", "date"]
    with replacing(rows) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([*head, *keys])
        for one in found:
            own = [one.part, one.contender, one.seed, one.error, " ".join(one.flags)]
            own += [one.fit.get(name) for name in head[5:]]
            writer.writerow([*own, *(one.values.get(key) for key in keys)])
    with replacing(whole) as temporary:
        entries = [
            {**one.fit, "error": one.error, "flags": one.flags, "figures": one.values} for one in found
        ]
        temporary.write_text(json.dumps(entries, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return rows, whole

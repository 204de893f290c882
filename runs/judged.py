"""What a benchmark's folder says of every fit: figures by `exact-1`, and what its summary says against it."""

import json
from collections.abc import Mapping
from pathlib import Path

Fits = dict[tuple[str, str], dict]


def judged(bench: Path, method: str) -> Fits:
    """By part and seed. said: whether the summary has doubts."""
    values = {}
    for path in sorted(bench.glob(f"fits/*/{method}/seed*/figures.json")):
        figures = json.loads(path.read_text(encoding="utf-8"))
        summary = path.with_name("summary.json")
        told = json.loads(summary.read_text(encoding="utf-8")) if summary.exists() else {}
        fit = json.loads(path.with_name("fit.json").read_text(encoding="utf-8"))
        values[path.parts[-4], path.parts[-2]] = {
            **figures["exact-1"],
            "said": bool(told.get("doubts")),
            "seconds": fit["seconds"],
            "where": f"commit {fit['commit']}, {fit['date']}, {fit['machine']}",
            "doubts": told.get("doubts"),
        }
    return values


def provenance(fits: Mapping[tuple[str, ...], dict]) -> str:
    """Which commits made them, when and where."""
    return "; ".join(sorted({one["where"] for one in fits.values()}))


def right(one: dict) -> bool:
    """Whether a mesh is closed, in as many pieces and with as many handles as the truth."""
    same = one["components"] == one["truth_components"] and one["genus"] == one["truth_genus"]
    return bool(one["watertight"]) and same

"""A benchmark by kind of part: how much better or worse than the baseline each contender is on which parts.

    python runs/kinds.py DATA OUT [--baseline odw]

DATA/index.csv says of every part its thickness, the share of its area that is curved, and its genus; OUT
is what `weingarten bench` wrote. A cell is the geometric mean, over the parts of a kind, of the exact CD
(mean over the seeds) over the baseline's, and how many fits have the right topology. Writes Markdown to
the standard output. Run it with the Python of the environment that weingarten is installed in.
"""

import argparse
import csv
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from weingarten.bench.rendering import markdown
from weingarten.bench.results import Result, results
from weingarten.bench.statistics import Figures, figures_of
from weingarten.bench.store import Store
from weingarten.bench.table import Cell, Table

CHAMFER, TOPOLOGY = "exact-1.chamfer", "exact-1.topology_right"
Row = dict[str, str]
KINDS: dict[str, Callable[[Row], bool]] = {
    "all": lambda row: True,
    "thin: thickness < 0.03": lambda row: float(row["thickness"]) < 0.03,
    "mostly flat: curved < 20 %": lambda row: float(row["curved_area_fraction"]) < 0.2,
    "mostly curved: > 50 %": lambda row: float(row["curved_area_fraction"]) > 0.5,
    "many holes: genus > 7": lambda row: int(row["genus"]) > 7,
}
"""Overlapping; the bounds were set before any method was compared by them."""


def index(data: Path) -> list[Row]:
    """What is known of every part."""
    with (data / "index.csv").open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def parts_of(rows: list[Row], kind: str) -> set[str]:
    """Names of the parts of a kind."""
    return {row["id"] for row in rows if KINDS[kind](row)}


def ratio(own: Figures, baseline: Figures, parts: set[str]) -> float | None:
    """Geometric mean of own over baseline on the parts and seeds that both have."""
    logs = [
        np.log(
            np.mean([own[part][seed] for seed in seeds]) / np.mean([baseline[part][seed] for seed in seeds])
        )
        for part in parts
        if part in own and part in baseline and (seeds := own[part].keys() & baseline[part].keys())
    ]
    return float(np.exp(np.mean(logs))) if logs else None


def right(own: Figures, parts: set[str]) -> str:
    """Share of the fits with components and genus right, %."""
    values = [value for part in parts if part in own for value in own[part].values()]
    return f"{100 * float(np.mean(values)):.0f} %" if values else "–"


def kinds_table(found: list[Result], rows: list[Row], baseline: str) -> Table:
    """A row a contender, best first on all parts."""
    reference = figures_of(found, baseline, CHAMFER)
    names = list(dict.fromkeys(one.contender for one in found))
    made: list[tuple[float, tuple[Cell, ...]]] = []
    for name in names:
        own, topology = figures_of(found, name, CHAMFER), figures_of(found, name, TOPOLOGY)
        ratios = {kind: ratio(own, reference, parts_of(rows, kind)) for kind in KINDS}
        cells = [
            Cell("–" if value is None else f"{value:.2f}; {right(topology, parts_of(rows, kind))}")
            for kind, value in ratios.items()
        ]
        made.append((ratios["all"] or float("inf"), (Cell(name), *cells)))
    there = {one.part for one in found}
    head = [f"{kind} ({len(parts_of(rows, kind) & there)} parts)" for kind in KINDS]
    caption = (
        f"Exact CD over that of {baseline}, geometric mean over the parts, below one is better; then the "
        "share of fits with components and genus right."
    )
    ordered = tuple(cells for _, cells in sorted(made, key=lambda row: row[0]))
    return Table("By kind of part", caption, ("", *head), ordered)


def main() -> None:
    """Read, compare, write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("data", type=Path, help="folder with index.csv")
    parser.add_argument("out", type=Path, help="folder of a benchmark")
    parser.add_argument("--baseline", default="odw", help="contender to compare with (default odw)")
    arguments = parser.parse_args()
    rows = index(arguments.data)
    found = [one for one in results(Store(arguments.out)) if one.good]
    sys.stdout.write(markdown(kinds_table(found, rows, arguments.baseline)))


if __name__ == "__main__":
    main()

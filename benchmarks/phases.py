"""Seconds of the whole `weingarten fit` command by phase, and its memory, on the bundled flange.

    python benchmarks/phases.py [--runs 3] [-- OPTIONS OF FIT]

The cloud has 30,000 points; without options, fit runs as it does by default. Phases are those that the
command itself tells with --json; "start and end" is what is left of the wall time: Python, imports, reading,
writing.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path
from statistics import median

from process import measured
from table import table

PROGRAM = str(Path(sys.executable).parent / "weingarten")
POINTS, HELP_RUNS = 30_000, 5
Row = dict[str, float]


def fitted(cloud: Path, options: list[str]) -> Row:
    """One fit: seconds by phase, of the whole, and MiB."""
    command = [PROGRAM, "fit", str(cloud), "-o", str(cloud.with_name("mesh.ply")), "--json"]
    outcome = measured([*command, *options])
    seconds: Row = json.loads(outcome.text)["summary"]["seconds"]
    rest = outcome.seconds - sum(seconds.values())
    return seconds | {"start and end": rest, "whole command": outcome.seconds, "peak MiB": outcome.peak}


def page(runs: list[Row], helps: list[float]) -> str:
    """The table: median, least and most of everything."""
    found = {name: [run[name] for run in runs] for name in runs[0]} | {"weingarten --help": helps}
    rows: list[list[str]] = []
    for name, values in found.items():
        digits = 0 if name == "peak MiB" else 2
        cells = [f"{value:,.{digits}f}" for value in (median(values), min(values), max(values))]
        rows.append([name, *cells, str(len(values))])
    return table(["seconds", "median", "least", "most", "runs"], rows)


def main() -> None:
    """Parse, measure, write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=3, help="fits (default 3)")
    parser.add_argument("options", nargs="*", help="options of `weingarten fit`, after --")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        cloud = Path(folder) / "flange.ply"
        measured([PROGRAM, "sample", "bundled:flange", "-o", str(cloud), "--points", str(POINTS)])
        runs = [fitted(cloud, arguments.options) for _ in range(arguments.runs)]
    helps = [measured([PROGRAM, "--help"]).seconds for _ in range(HELP_RUNS)]
    given = " ".join(["weingarten fit", *arguments.options])
    sys.stdout.write(f"{given}, bundled flange, {POINTS:,} points\n{page(runs, helps)}")


if __name__ == "__main__":
    main()

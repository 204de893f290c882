"""Mutated files of every format, many of them, each read in bounds: nothing but our own errors may come out.

    python runs/fuzz.py --inputs 100000 --seed 0

reads the mutations 0, 1, 2, … of a valid file of every reader and encoding (tests/io/mutation.py), as many
of each, 100,000 in all, and adds a row a reader to results/fuzz.csv, from which results/fuzz.md is made.
--seed says with which mutation to go on another time. A failure is printed with its seed; the exit code is 1.
"""

import argparse
import csv
import resource
import shlex
import sys
import tempfile
import time
from dataclasses import asdict, dataclass, fields
from multiprocessing import get_context
from pathlib import Path
from typing import cast

from weingarten.atomic import replacing
from weingarten.report.provenance import commit, machine, today

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests" / "io"))

from files import every_valid_file, read  # noqa: E402
from mutation import mutated  # noqa: E402
from reading_in_bounds import MEMORY, SECONDS, bounded, outcome  # noqa: E402


@dataclass(frozen=True)
class Row:
    """What became of the mutations `first` to `first + inputs` of one valid file.

    slowest: seconds; slowest_seed: of which mutation. peak: megabytes that the process grew by.
    """

    reader: str
    first: int
    inputs: int
    failures: int
    slowest: float
    slowest_seed: int
    peak: float
    seconds: float
    commit: str
    date: str


def row(label: str, first: int, inputs: int, where: tuple[str, str]) -> Row:
    """Read the mutations of one file, in a process of its own. Failures are told as they come."""
    valid = every_valid_file()
    file, others = valid[label], [one.content for one in valid.values()]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / file.name
        # imports are no reader's seconds or megabytes
        path.write_bytes(file.content)
        read(file.reader, path)
        bounded(MEMORY)
        before, started, failures, slowest = peak(), time.perf_counter(), 0, (0.0, first)
        for seed in range(first, first + inputs):
            path.write_bytes(mutated(file.name, file.content, seed, others))
            begun = time.perf_counter()
            if wrong := outcome(file.reader, path):
                failures += 1
                sys.stderr.write(f"{label}, mutation {seed}: {wrong}\n")
            slowest = max(slowest, (time.perf_counter() - begun, seed))
    seconds, grown = time.perf_counter() - started, peak() - before
    return Row(
        label,
        first,
        inputs,
        failures,
        round(slowest[0], 4),
        slowest[1],
        round(grown, 1),
        round(seconds, 1),
        *where,
    )


def peak() -> float:
    """The most memory that this process has had, megabytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform == "linux" else 1 << 20)


def earlier(path: Path) -> list[Row]:
    """The rows that there are."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as stream:
        return [
            Row(**{one.name: cast(type, one.type)(values[one.name]) for one in fields(Row)})
            for values in csv.DictReader(stream)
        ]


def write(rows: list[Row], path: Path) -> None:
    """All rows as CSV, and beside it their sums as a page."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, [one.name for one in fields(Row)], lineterminator="\n")
        writer.writeheader()
        writer.writerows([asdict(row) for row in rows])
    commits = ", ".join(sorted({one.commit for one in rows}))
    dates = sorted({one.date for one in rows})
    lines = [
        "# Mutated files of every format",
        "",
        f"`{shlex.join(['python', *sys.argv])}`, the last of the slices that are summed here, {dates[0]} to "
        f"{dates[-1]}, commit {commits}, {machine()}.",
        "",
        f"{sum(one.inputs for one in rows):,} inputs in {sum(one.seconds for one in rows):,.0f} s; "
        f"{sum(one.failures for one in rows)} ended otherwise than with points, a mesh or one of our errors. "
        f"Each had {SECONDS} s, and its process {MEMORY >> 20} MB more than it began with.",
        "",
        "| reader | inputs | failures | slowest input, s | its seed | process grew by, MB |",
        "|---|---|---|---|---|---|",
    ]
    for label in dict.fromkeys(one.reader for one in rows):
        own = [one for one in rows if one.reader == label]
        slow = max(own, key=lambda one: one.slowest)
        lines.append(
            f"| {label} | {sum(one.inputs for one in own):,} | {sum(one.failures for one in own)} "
            f"| {slow.slowest:.3f} | {slow.slowest_seed} | {max(one.peak for one in own):.1f} |"
        )
    with replacing(path.with_suffix(".md")) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> int:
    """Read, and write what was found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--inputs", type=int, default=100_000, help="in all")
    parser.add_argument("--seed", type=int, default=0, help="the first mutation of each file")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results" / "fuzz.csv")
    arguments = parser.parse_args()
    labels = list(every_valid_file())
    each = -(-arguments.inputs // len(labels))
    where = (commit(ROOT), str(today()))
    tasks = [(label, arguments.seed, each, where) for label in labels]
    with get_context("fork").Pool(1, maxtasksperchild=1) as pool:
        found = pool.starmap(row, tasks, chunksize=1)
    kept = [one for one in earlier(arguments.output) if one.first != arguments.seed]
    write(sorted(kept + found, key=lambda one: (labels.index(one.reader), one.first)), arguments.output)
    return int(any(one.failures for one in found))


if __name__ == "__main__":
    sys.exit(main())

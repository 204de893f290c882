"""How time and memory grow with points a step, width, resolution and the size of the cloud.

    python benchmarks/scaling.py [--only points width resolution cloud] [--largest 1000000]

Every line is measured in a process of its own, so that its peak memory is its own. Beside each figure stands
the exponent from the line above: the logarithm of the figures' ratio over that of the sizes'. Steps are the
standard preset's with curvature, at one number of points from first to last; the field that is extracted has
had a fit of 100 steps; a cloud's line has what `weingarten fit` does before and in its first five steps, with
a binary PLY file. All on the bundled flange.
"""

import argparse
import json
import math
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from statistics import median

from process import measured
from table import table

POINTS, TIMED_STEPS = 30_000, 20
PROGRAM = str(Path(sys.executable).parent / "weingarten")
FITTED_STEPS, COARSE = 100, 32
FIRST_STEPS = 5
Row = dict[str, float]


def points_row(points: int) -> Row:
    """A step by the points of each kind."""
    return step_row(points=points)


def width_row(width: int) -> Row:
    """A step by the width of the network."""
    return step_row(width=width)


def step_row(**changes: int) -> Row:
    """Median seconds of a step with the settings changed so; the first step is left out."""
    import torch

    from weingarten.reconstruction import prepared
    from weingarten.samples.parts import sample_part
    from weingarten.settings import resolve

    settings = replace(resolve("standard"), ramp=(1.0, 1.0), **changes)
    loop = prepared(sample_part("flange", POINTS, 0), settings, torch.device("cpu"))
    with loop.crew:
        loop.advance()
        seconds = [timed(loop.advance) for _ in range(TIMED_STEPS)]
    return {"s/step": median(seconds)}


def resolution_row(resolution: int) -> Row:
    """An extraction by its resolution, after a coarse one to warm up."""
    import numpy as np
    import torch

    from weingarten.samples.parts import sample_part
    from weingarten.settings import resolve
    from weingarten.start import Start
    from weingarten.surface.contour import extraction
    from weingarten.surface.values import BATCH, field_values

    settings, points = resolve("standard", steps=FITTED_STEPS), sample_part("flange", POINTS, 0)
    start = Start.of(points, settings, torch.device("cpu"))
    loop, origin = start.loop(), start.origin
    with loop.crew:
        for _ in range(FITTED_STEPS):
            loop.advance()
    lower, upper = np.array(origin.lower), np.array(origin.upper)
    values = field_values(loop.field, loop.crew)
    extraction(values, lower, upper, COARSE, BATCH, loop.crew)
    started = time.perf_counter()
    found = extraction(values, lower, upper, resolution, BATCH, loop.crew)
    return {"extraction s": time.perf_counter() - started, "evaluations": found.evaluations}


def cloud_row(path: Path) -> Row:
    """The beginning of a fit to the cloud of a file."""
    import torch

    from weingarten.io.points import read_points
    from weingarten.reconstruction import prepared
    from weingarten.settings import resolve

    started = time.perf_counter()
    points = read_points(path)
    read = time.perf_counter()
    loop = prepared(points, resolve("standard"), torch.device("cpu"))
    ready = time.perf_counter()
    with loop.crew:
        for _ in range(FIRST_STEPS):
            loop.advance()
    last = time.perf_counter()
    return {"reading s": read - started, "preparing s": ready - read, "5 steps s": last - ready}


def timed(work: Callable[[], object]) -> float:
    """Seconds of one call."""
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


CLOUDS = (10_000, 100_000, 1_000_000, 10_000_000)
ROWS: dict[str, tuple[Callable[..., Row], tuple[int, ...]]] = {
    "points": (points_row, (250, 500, 1000, 2000, 4000, 8000)),
    "width": (width_row, (64, 128, 256, 512)),
    "resolution": (resolution_row, (64, 128, 256, 512)),
    "cloud": (cloud_row, CLOUDS),
}


def served(kind: str, size: int) -> Row:
    """A row from a process of its own, with its peak memory; a cloud is sampled by another before."""
    with tempfile.TemporaryDirectory() as folder:
        subject = str(size)
        if kind == "cloud":
            subject = str(Path(folder) / "cloud.ply")
            measured([PROGRAM, "sample", "bundled:flange", "-o", subject, "--points", str(size)])
        outcome = measured([sys.executable, __file__, "--measure", kind, subject])
    return json.loads(outcome.text) | {"peak MiB": outcome.peak}


def section(kind: str, sizes: list[int]) -> str:
    """The table of one quantity."""
    found = {size: served(kind, size) for size in sizes}
    names = list(found[sizes[0]])
    cells = {size: [shown(found[size][name]) for name in names] for size in sizes}
    powers = {sizes[0]: [""] * len(names)}
    for (a, before), (b, after) in pairwise(found.items()):
        powers[b] = [f"{math.log(after[name] / before[name]) / math.log(b / a):.2f}" for name in names]
    headings = [kind, *(heading for name in names for heading in (name, "exponent"))]
    rows = [[f"{size:,}", *interleaved(cells[size], powers[size])] for size in sizes]
    return table(headings, rows)


def interleaved(first: list[str], second: list[str]) -> list[str]:
    """One of each in turn."""
    return [cell for pair in zip(first, second, strict=True) for cell in pair]


def shown(value: float) -> str:
    """Three digits, or all before the point."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def measure(kind: str, subject: str) -> str:
    """A row as JSON, in this process. subject: the size, or the file of the cloud."""
    from weingarten.cli.memory import keep_freed_memory

    keep_freed_memory()
    return json.dumps(ROWS[kind][0](Path(subject) if kind == "cloud" else int(subject))) + "\n"


def main() -> None:
    """Parse, measure, write the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", choices=ROWS, default=list(ROWS), help="these alone")
    parser.add_argument(
        "--largest", type=int, choices=CLOUDS, default=CLOUDS[-2], help="points of the largest cloud"
    )
    parser.add_argument("--measure", nargs=2, metavar=("KIND", "SUBJECT"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure:
        sys.stdout.write(measure(*arguments.measure))
        return
    limits = {"cloud": arguments.largest}
    for number, kind in enumerate(arguments.only):
        sizes = [size for size in ROWS[kind][1] if size <= limits.get(kind, size)]
        sys.stdout.write("\n" * (number > 0) + section(kind, sizes))
        sys.stdout.flush()


if __name__ == "__main__":
    main()

"""Many small fits in one process: memory, threads and open files stay as they are.

    python runs/soak.py --fits 200
    python runs/soak.py --fits 100 --same -o results/soak-same.md

fits a bundled part again and again, with another seed each time or with the same, extracts, writes and reads
the mesh, and writes results/soak.csv, a row a fit, and results/soak.md. Memory is, after a collection of
garbage, what the process has resident, and what of it the C library has handed out and not got back: the
first also grows by gaps between what is in use. The slopes are those of the straight lines of least squares
through all fits after the first quarter.
"""

import argparse
import csv
import ctypes
import gc
import shlex
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
import psutil

from weingarten.atomic import replacing
from weingarten.io.mesh import read_mesh, write_mesh
from weingarten.reconstruction import reconstruct
from weingarten.report.provenance import commit, machine, today
from weingarten.samples.parts import sample_part
from weingarten.settings import resolve

ROOT = Path(__file__).parents[1]
WARM_UP = 0.25
COLUMNS = ("fit", "seconds", "resident_mb", "in_use_mb", "threads", "files")
Row = tuple[int, float, float, float, int, int]

GLIBC = (
    "arena",
    "ordblks",
    "smblks",
    "hblks",
    "hblkhd",
    "usmblks",
    "fsmblks",
    "uordblks",
    "fordblks",
    "keepcost",
)


class Allocated(ctypes.Structure):
    """What glibc's mallinfo2 returns."""

    _fields_ = [(name, ctypes.c_size_t) for name in GLIBC]


def in_use() -> float:
    """MB that are handed out, from the heaps and as mappings of their own; NaN without glibc 2.33."""
    ask = getattr(ctypes.CDLL(None), "mallinfo2", None)
    if ask is None:
        return float("nan")
    ask.restype = Allocated
    found = ask()
    return (found.uordblks + found.hblkhd) / 2**20


def fitted(number: int, seed: int, folder: Path) -> Row:
    """One fit, and what the process has after it."""
    started = time.perf_counter()
    settings = resolve(steps=30, points=100, resolution=32, seed=seed)
    result = reconstruct(sample_part("flange", 1500, seed), settings, run_folder=folder / "run")
    write_mesh(folder / "part.stl", result.mesh)
    read_mesh(folder / "part.stl")
    del result
    gc.collect()
    process = psutil.Process()
    seconds, resident = time.perf_counter() - started, process.memory_info().rss / 2**20
    memory = round(resident, 2), round(in_use(), 3)
    return number, round(seconds, 3), *memory, threading.active_count(), process.num_fds()


def trend(fits: np.ndarray, memory: np.ndarray) -> str:
    """Of memory in MB over the fits' numbers, in words."""
    slope, start = np.polyfit(fits, memory, 1)
    spread = float(np.std(memory - (start + slope * fits)))
    error = spread / (float(np.std(fits)) * len(fits) ** 0.5)
    first, second = np.split(memory, [len(memory) // 2])
    return (
        f"{1024 * slope:+.1f} kB a fit ± {1024 * error:.1f} (scatter {spread:.2f} MB); "
        f"mean of the first half {first.mean():.2f} MB, of the second {second.mean():.2f}, "
        f"least {memory.min():.1f}, most {memory.max():.1f};"
    )


def page(rows: list[Row], source: str) -> str:
    """The figures in words. source: the commit that was run."""
    table = np.array(rows, dtype=np.float64)
    warm = table[int(WARM_UP * len(table)) :]
    lines = [
        "# Many fits in one process",
        "",
        f"`{shlex.join(['python', *sys.argv])}`, {today()}, commit {source}, {machine()}.",
        "",
        f"{len(rows)} fits of the bundled flange, 1,500 points, 30 steps, resolution 32, "
        f"{np.median(table[:, 1]):.1f} s each. After the first {len(rows) - len(warm)}:",
        "",
        f"- resident memory: {trend(warm[:, 0], warm[:, 2])}",
        f"- of it in use: {trend(warm[:, 0], warm[:, 3])}",
        f"- threads: {warm[:, 4].min():.0f} to {warm[:, 4].max():.0f};",
        f"- open files: {warm[:, 5].min():.0f} to {warm[:, 5].max():.0f}.",
        "",
        "Slopes by least squares; their error is the scatter about the line, over the standard deviation of "
        f"the fits' numbers, {np.std(warm[:, 0]):.1f}, times √{len(warm)}.",
        "",
    ]
    return "\n".join(lines)


def main() -> None:
    """Fit, and write what was seen."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--fits", type=int, default=200)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results" / "soak.md")
    parser.add_argument("--same", action="store_true", help="the same seed and points in every fit")
    arguments = parser.parse_args()
    # what runs is what is there now, whatever is checked out before the last fit
    source = commit(ROOT)
    with tempfile.TemporaryDirectory() as folder:
        seeds = [0 if arguments.same else number for number in range(arguments.fits)]
        rows = [fitted(number, seed, Path(folder)) for number, seed in enumerate(seeds)]
    table = arguments.output.with_suffix(".csv")
    with replacing(table) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        csv.writer(stream, lineterminator="\n").writerows([COLUMNS, *rows])
    with replacing(arguments.output) as temporary:
        temporary.write_text(page(rows, source), encoding="utf-8")


if __name__ == "__main__":
    main()

"""Many small fits in one process: memory, threads and open files stay as they are.

    python runs/soak.py --fits 200

fits a bundled part again and again, with another seed each time, extracts, writes and reads the mesh, and
writes results/soak.csv, a row a fit, and results/soak.md. Memory is what the process has resident after
a collection of garbage; its slope is that of the straight line of least squares through all fits after the
first quarter.
"""

import argparse
import csv
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
COLUMNS = ("fit", "seconds", "resident_mb", "threads", "files")
Row = tuple[int, float, float, int, int]


def fitted(number: int, folder: Path) -> Row:
    """One fit, and what the process has after it."""
    started = time.perf_counter()
    settings = resolve(steps=30, points=100, resolution=32, seed=number)
    result = reconstruct(sample_part("flange", 1500, number), settings, run_folder=folder / "run")
    write_mesh(folder / "part.stl", result.mesh)
    read_mesh(folder / "part.stl")
    del result
    gc.collect()
    process = psutil.Process()
    seconds, resident = time.perf_counter() - started, process.memory_info().rss / 2**20
    return number, round(seconds, 3), round(resident, 2), threading.active_count(), process.num_fds()


def page(rows: list[Row]) -> str:
    """The figures in words."""
    table = np.array(rows, dtype=np.float64)
    warm = table[int(WARM_UP * len(table)) :]
    fits, resident = warm[:, 0], warm[:, 2]
    slope, start = np.polyfit(fits, resident, 1)
    spread = float(np.std(resident - (start + slope * fits)))
    error = spread / (float(np.std(fits)) * len(fits) ** 0.5)
    half = len(resident) // 2
    deviation, half_means = np.std(fits), (resident[:half].mean(), resident[half:].mean())
    memory = (
        f"resident memory: {1024 * slope:+.1f} kB a fit ± {1024 * error:.1f} (least squares; the error is "
        f"the scatter, {spread:.2f} MB, over the standard deviation of the fits' numbers, {deviation:.1f}, "
        f"times √{len(fits)}); mean of the first half {half_means[0]:.1f} MB, of the second "
        f"{half_means[1]:.1f}, least {resident.min():.1f}, most {resident.max():.1f};"
    )
    lines = [
        "# Many fits in one process",
        "",
        f"`{shlex.join(['python', *sys.argv])}`, {today()}, commit {commit(ROOT)}, {machine()}.",
        "",
        f"{len(rows)} fits of the bundled flange, 1,500 points, 30 steps, resolution 32, "
        f"{np.median(table[:, 1]):.1f} s each. After the first {len(rows) - len(warm)}:",
        "",
        f"- {memory}",
        f"- threads: {warm[:, 3].min():.0f} to {warm[:, 3].max():.0f};",
        f"- open files: {warm[:, 4].min():.0f} to {warm[:, 4].max():.0f}.",
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
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [fitted(number, Path(folder)) for number in range(arguments.fits)]
    table = arguments.output.with_suffix(".csv")
    with replacing(table) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        csv.writer(stream, lineterminator="\n").writerows([COLUMNS, *rows])
    with replacing(arguments.output) as temporary:
        temporary.write_text(page(rows), encoding="utf-8")


if __name__ == "__main__":
    main()

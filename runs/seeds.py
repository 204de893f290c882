"""The 25 parts over several seeds: mean, spread and worst, and part by part against screened Poisson.

    python runs/seeds.py [--preset standard]

Reads what `runs/abc25.py` wrote for this preset, results/abc25-PRESET*.csv, and Poisson's rows of
results/reproduced-standard.csv, which has clouds of the same size of the same parts. Writes
results/abc25-PRESET-seeds.md.
"""

import argparse
import csv
import statistics
import sys
from pathlib import Path

from weingarten.report.provenance import commit, today

RESULTS = Path(__file__).resolve().parent.parent / "results"
POISSON = RESULTS / "reproduced-standard.csv"
Row = dict[str, str]
METRICS = (
    ("nc", "NC, %", "ceiling_nc"),
    ("cd_e3", "CD ×10³", "ceiling_cd_e3"),
    ("f1", "F1, %", "ceiling_f1"),
    ("exact_cd_e3", "exact CD ×10³", None),
    ("exact_p95_e3", "exact 95th percentile ×10³", None),
    ("exact_hausdorff_e3", "exact Hausdorff ×10³", None),
    ("exact_nc", "exact NC, %", None),
    ("exact_edge_f1", "exact edge F1, %", None),
    ("seconds", "seconds, whole process", None),
    ("peak_mb", "peak MB", None),
)
LARGE_IS_GOOD = ("nc", "f1", "exact_nc", "exact_edge_f1")


def rows_of(path: Path) -> list[Row]:
    """Of a CSV file."""
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def right(row: Row) -> bool:
    """Whether a mesh is closed, in as many pieces and with as many handles as the truth."""
    same = row["components"] == row["true_components"] and row["genus"] == row["true_genus"]
    return row["watertight"] == "True" and same


def metric_line(key: str, heading: str, ceiling: str | None, seeds: list[list[Row]]) -> str:
    """Mean over parts and seeds, s.d. between parts, s.d. of the mean between seeds, worst fit, ceiling."""
    means = [statistics.mean(float(row[key]) for row in rows) for rows in seeds]
    parts = [statistics.mean(float(row[key]) for row in own) for own in zip(*seeds, strict=True)]
    every = [float(row[key]) for rows in seeds for row in rows]
    worst = min(every) if key in LARGE_IS_GOOD else max(every)
    between = f"{statistics.stdev(means):.3f}" if len(means) > 1 else "–"
    best = f"{statistics.mean(float(row[ceiling]) for row in seeds[0]):.3f}" if ceiling else "–"
    mean, spread = statistics.mean(means), statistics.stdev(parts)
    return f"| {heading} | {mean:.3f} | {spread:.3f} | {between} | {worst:.3f} | {best} |"


def poisson_means() -> dict[str, float]:
    """Published CD ×10³ of screened Poisson by part, mean over its seeds."""
    found: dict[str, list[float]] = {}
    for row in rows_of(POISSON):
        if row["contender"] == "poisson":
            found.setdefault(row["part"], []).append(1000 * float(row["published-1.chamfer"]))
    return {part: statistics.mean(values) for part, values in found.items()}


def part_lines(seeds: list[list[Row]]) -> list[str]:
    """A line a part: CD, its ceiling, Poisson's, and in how many fits the topology is right."""
    poisson = poisson_means()
    lines = []
    for own in zip(*seeds, strict=True):
        part, distances = own[0]["part"], [float(row["cd_e3"]) for row in own]
        mean = statistics.mean(distances)
        cells = [part, f"{mean:.3f}", f"{max(distances):.3f}", f"{float(own[0]['ceiling_cd_e3']):.2f}"]
        cells += [f"{poisson[part]:.3f}", f"{mean - poisson[part]:+.3f}"]
        cells += [f"{sum(map(right, own))} of {len(own)}"]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def page(preset: str, files: list[Path]) -> str:
    """The table."""
    seeds = [rows_of(path) for path in files]
    metrics = [one for one in METRICS if all(row.get(one[0]) for rows in seeds for row in rows)]
    topology = ", ".join(f"{sum(map(right, rows))} of {len(rows)}" for rows in seeds)
    commits = ", ".join(sorted({row["commit"] for rows in seeds for row in rows}))
    lines = [
        f"# abc25-{preset}: {len(seeds)} seeds",
        "",
        f"- command: `python runs/abc25.py DATA OUT --preset {preset} --seed K`, then `python runs/seeds.py`",
        f"- fits of commit {commits}; table of commit {commit(RESULTS.parent)}; date: {today()}",
        f"- components and genus right, and watertight, by seed: {topology}",
        "",
        "| | mean | s.d. between parts | s.d. of the mean between seeds | worst fit | ceiling |",
        "|---|---:|---:|---:|---:|---:|",
        *(metric_line(*one, seeds) for one in metrics),
        "",
        "CD ×10³ by protocol published-1; Poisson of results/reproduced-standard.csv, three seeds.",
        "",
        "| part | CD, mean of seeds | worst seed | ceiling | Poisson | difference | topology right |",
        "|---|---:|---:|---:|---:|---:|---:|",
        *part_lines(seeds),
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Read, tabulate, write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--preset", default="standard")
    preset = parser.parse_args().preset
    files = sorted(RESULTS.glob(f"abc25-{preset}*.csv"), key=lambda path: (len(path.stem), path.stem))
    if not files:
        sys.stderr.write(f"There is no results/abc25-{preset}*.csv; run runs/abc25.py first.\n")
        return 2
    target = RESULTS / f"abc25-{preset}-seeds.md"
    target.write_text(page(preset, files), encoding="utf-8")
    sys.stdout.write(f"results/{target.name}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Every model of a folder, from 30,000 samples to the published and the exact figures, in one table.

    python runs/abc25.py DATA OUT [--preset standard] [--seed 0] [--only abc_00000003 ...]

DATA holds abc_*.ply and index.csv (columns id, self_nc_elementwise, self_cd_e3, self_f1: what each model
scores against a sample of itself). OUT keeps the cloud, the mesh, the log and record.json of every part; a
part that has its record is not run again. Writes results/abc25-PRESET.csv and .md, from all records in OUT
that have this preset and seed. Run it with the Python of the environment that weingarten is installed in.

A fit's seconds and peak memory are those of the whole `weingarten fit` process, as the system counts them.
"""

import argparse
import csv
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from weingarten.report.provenance import commit, machine, today

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(sys.executable).parent / "weingarten"
POINTS, SAMPLE_SEED = 30_000, 0
Row = dict[str, str | float | int | bool | None]


@dataclass(frozen=True)
class Statistic:
    """One column with a mean: its key in a row, heading, digits, and which end is the worst."""

    key: str
    heading: str
    digits: int
    worst: Callable[[list[float]], float]


STATISTICS = (
    Statistic("nc", "NC", 2, min),
    Statistic("cd_e3", "CD ×10³", 2, max),
    Statistic("f1", "F1", 2, min),
    Statistic("ceiling_nc", "ceiling NC", 2, min),
    Statistic("ceiling_cd_e3", "ceiling CD", 2, max),
    Statistic("ceiling_f1", "ceiling F1", 2, min),
)
COSTS = (Statistic("seconds", "seconds", 1, max), Statistic("peak_mb", "peak MB", 0, max))


class PartFailed(Exception):  # noqa: N818  (it is caught, noted in the table, and the next part begins)
    """A command of one part failed."""


def measured(command: list[str], log: Path) -> tuple[str, float, float]:
    """Run a command; its standard output, its wall seconds and its peak memory in MB. Errors go to `log`."""
    output = log.with_suffix(".out")
    with output.open("wb") as stdout, log.open("ab") as stderr:
        started = time.perf_counter()
        process = subprocess.Popen(command, stdout=stdout, stderr=stderr)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - started
        process.returncode = os.waitstatus_to_exitcode(status)
    text = output.read_text(encoding="utf-8")
    output.unlink()
    if process.returncode != 0:
        raise PartFailed(f"`weingarten {command[1]}` ended with code {process.returncode}; see {log}")
    unit = 1 if sys.platform == "darwin" else 1024
    return text, seconds, usage.ru_maxrss * unit / 1e6


def record_of(truth: Path, folder: Path, chosen: argparse.Namespace) -> dict:
    """Sample, fit and evaluate one part; everything that is to be known of it."""
    program = str(PROGRAM)
    record = {"part": truth.stem, "commit": commit(ROOT), "machine": machine(), "date": str(today())}
    folder.mkdir(parents=True, exist_ok=True)
    cloud, mesh, log = (folder / name for name in ("cloud.ply", "mesh.ply", "log.txt"))
    log.unlink(missing_ok=True)
    sampling = ["--points", str(POINTS), "--seed", str(SAMPLE_SEED)]
    measured([program, "sample", str(truth), "-o", str(cloud), *sampling], log)
    fitting = ["--preset", chosen.preset, "--seed", str(chosen.seed), "--json"]
    text, seconds, peak = measured([program, "fit", str(cloud), "-o", str(mesh), *fitting], log)
    record |= {"seconds": seconds, "peak_mb": peak, "fit": json.loads(text)}
    for protocol in ("published", "exact"):
        comparing = ["--protocol", protocol, "--json"]
        record[protocol] = json.loads(
            measured([program, "evaluate", str(mesh), str(truth), *comparing], log)[0]
        )
    return record


def row_of(record: dict, ceiling: dict[str, str]) -> Row:
    """A part's row, in the units of the published tables: NC and F1 × 100, lengths × 1000."""
    published, exact = record["published"], record["exact"]
    return {
        "part": record["part"],
        "nc": published["normal_consistency"] * 100,
        "cd_e3": published["chamfer"] * 1000,
        "f1": published["f1"] * 100,
        "ceiling_nc": float(ceiling["self_nc_elementwise"]),
        "ceiling_cd_e3": float(ceiling["self_cd_e3"]),
        "ceiling_f1": float(ceiling["self_f1"]),
        "components": exact["components"],
        "true_components": exact["truth_components"],
        "genus": exact["genus"],
        "true_genus": exact["truth_genus"],
        "watertight": exact["watertight"],
        "seconds": record["seconds"],
        "peak_mb": record["peak_mb"],
        "exact_cd_e3": exact["chamfer"] * 1000,
        "exact_p95_e3": exact["distance_95"] * 1000,
        "exact_hausdorff_e3": exact["hausdorff"] * 1000,
        "exact_f1_005": exact["f1_005"] * 100,
        "exact_f1_001": exact["f1_001"] * 100,
        "exact_nc": exact["normal_consistency"] * 100,
        "exact_edge_f1": exact["edge_f1"] * 100 if exact["edge_f1"] is not None else None,
        "self_intersecting": record["fit"]["summary"]["self_intersecting"],
        "volume_ratio": exact["volume_ratio"],
        "published_protocol": published["protocol"],
        "exact_protocol": exact["protocol"],
        "commit": record["commit"],
        "date": record["date"],
    }


def topology_right(row: Row) -> bool:
    """Whether the mesh is closed, in as many pieces and with as many handles as the truth."""
    same = row["components"] == row["true_components"] and row["genus"] == row["true_genus"]
    return bool(row["watertight"]) and same


def markdown_row(cells: list[str]) -> str:
    """One line of a table."""
    return f"| {' | '.join(cells)} |"


def cells_of(row: Row) -> list[str]:
    """A part's cells."""
    genus = "–" if row["genus"] is None else row["genus"]
    middle = [
        f"{row['components']} / {row['true_components']}",
        f"{genus} / {row['true_genus']}",
        "yes" if row["watertight"] else "**no**",
    ]
    figures = [f"{row[s.key]:.{s.digits}f}" for s in STATISTICS]
    return [str(row["part"]), *figures, *middle, *(f"{row[s.key]:.{s.digits}f}" for s in COSTS)]


def summary_rows(rows: list[Row]) -> list[list[str]]:
    """Mean, standard deviation (n − 1), median and worst of every column that has them."""
    columns = [["**mean**", "**s.d.**", "**median**", "**worst**"]]
    for statistic in (*STATISTICS, *COSTS):
        values = [float(row[statistic.key] or 0.0) for row in rows]
        spread = statistics.stdev(values) if len(values) > 1 else 0.0
        found = (statistics.mean(values), spread, statistics.median(values), statistic.worst(values))
        columns.append([f"{value:.{statistic.digits}f}" for value in found])
    columns[len(STATISTICS) + 1 : len(STATISTICS) + 1] = [[""] * 4] * 3
    return [list(cells) for cells in zip(*columns, strict=True)]


def table(
    rows: list[Row], records: list[dict], failed: dict[str, str], total: int, chosen: argparse.Namespace
) -> str:
    """The Markdown page."""
    headings = ["part", *(s.heading for s in STATISTICS), "components, found / true"]
    headings += ["genus, found / true", "watertight", *(s.heading for s in COSTS)]
    right, closed = sum(map(topology_right, rows)), sum(bool(row["watertight"]) for row in rows)
    protocol = rows[0]["published_protocol"] if rows else ""
    lines = [
        f"# {name_of(chosen)}: {len(rows)} of {total} parts",
        "",
        f"- command: `python runs/abc25.py DATA OUT --preset {chosen.preset} --seed {chosen.seed}`",
        f"- commit: {said(records, 'commit')}; date: {said(records, 'date')}",
        f"- machine: {said(records, 'machine')}",
        f"- {POINTS:,} uniform samples a part (seed {SAMPLE_SEED}); protocol {protocol}; NC and F1 in %, "
        "CD in 10⁻³ of the unit cube; the ceiling is the truth against a sample of itself",
        "- seconds and peak memory: the whole `weingarten fit` process",
        f"- components and genus right, and watertight: {right} of {len(rows)}; watertight: {closed}",
        *(f"- **failed**: {part}: {reason}" for part, reason in failed.items()),
        "",
        markdown_row(headings),
        markdown_row(["---", *["---:"] * (len(headings) - 1)]),
        *(markdown_row(cells_of(row)) for row in rows),
        *(markdown_row(cells) for cells in (summary_rows(rows) if rows else [])),
    ]
    return "\n".join(lines) + "\n"


def said(records: list[dict], key: str) -> str:
    """What the records say under a key; all of it, where they differ."""
    return ", ".join(sorted({record[key] for record in records}))


def name_of(chosen: argparse.Namespace) -> str:
    """What this experiment's files are called."""
    return f"abc25-{chosen.preset}" + (f"-seed{chosen.seed}" if chosen.seed else "")


def write(
    folder: Path, ceilings: dict[str, dict[str, str]], failed: dict[str, str], chosen: argparse.Namespace
) -> None:
    """Both tables, of all the records there are."""
    paths = [folder / part / "record.json" for part in ceilings]
    records = [json.loads(path.read_text(encoding="utf-8")) for path in paths if path.exists()]
    rows = [row_of(record, ceilings[record["part"]]) for record in records]
    target = ROOT / "results" / name_of(chosen)
    if rows:
        with target.with_suffix(".csv").open("w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    page = table(rows, records, failed, len(ceilings), chosen)
    target.with_suffix(".md").write_text(page, encoding="utf-8")


def options() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA")
    parser.add_argument("out", type=Path, metavar="OUT")
    parser.add_argument("--preset", default="standard")
    parser.add_argument("--seed", type=int, default=0, help="seed of the fit")
    parser.add_argument("--only", nargs="+", default=[], metavar="PART", help="these parts alone")
    return parser.parse_args()


def main() -> int:
    """Run what is missing and write the tables after every part; 1 if a part failed."""
    chosen = options()
    if not PROGRAM.exists():
        sys.stderr.write("There is no weingarten beside this Python; use the Python of its environment.\n")
        return 2
    with (chosen.data / "index.csv").open(newline="", encoding="utf-8") as stream:
        ceilings = {row["id"]: row for row in csv.DictReader(stream)}
    unknown = set(chosen.only) - set(ceilings)
    if unknown:
        sys.stderr.write(f"There is no part {', '.join(sorted(unknown))} in {chosen.data / 'index.csv'}.\n")
        return 2
    folder = chosen.out / name_of(chosen)
    failed: dict[str, str] = {}
    for part in chosen.only or ceilings:
        path = folder / part / "record.json"
        if not path.exists():
            sys.stderr.write(f"{part} …\n")
            try:
                record = record_of(chosen.data / f"{part}.ply", path.parent, chosen)
            except PartFailed as error:
                failed[part] = str(error).split(";")[0]
                sys.stderr.write(f"{part}: {error}\n")
            else:
                path.with_suffix(".new").write_text(json.dumps(record, indent=1), encoding="utf-8")
                path.with_suffix(".new").replace(path)
        write(folder, ceilings, failed, chosen)
    sys.stdout.write(f"results/{name_of(chosen)}.md\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

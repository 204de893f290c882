"""Clouds as scans really are: every kind and level of damage, weingarten beside screened Poisson.

    python runs/damage.py DATA OUT [--parts abc_00000003 ...] [--rows noise-0.5 ...] [--seeds 3] [--jobs 2]
    python runs/damage.py DATA OUT --table

DATA holds true meshes. Each row is a benchmark of its own in OUT/ROW: `weingarten sample` damages a scan of
every part, `weingarten bench` fits and judges; what is there is not made again. OUT begins with what
results/damage.tar.xz has, which is written anew after every row. --table writes results/damage.md from what
OUT holds. Run it with the Python of the environment that has weingarten.
"""

import argparse
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from judged import Fits, judged, provenance, right
from kept import pack, unpack

from weingarten.io.mesh import read_mesh, write_mesh
from weingarten.mesh import Mesh

ROOT = Path(__file__).resolve().parent.parent
ARCHIVE = ROOT / "results" / "damage.tar.xz"
PROGRAM = Path(sys.executable).parent / "weingarten"
METHODS = ("odw-oriented", "poisson")
PARTS = tuple(f"abc_{number:08d}" for number in (3, 4, 6, 68, 77, 125, 129, 168, 272, 801))
"""By default the first ten of the index."""

BAD = 2.0
"""A result is bad whose distance is so many times that of the same part from a clean scan, or not closed,
or in other pieces or with other handles than the truth."""


@dataclass(frozen=True)
class Row:
    """A kind and level of damage. noise: s.d. in diagonals of the part's box. options: of
    `weingarten sample`. pair: whether the next part stands beside it in the same cloud.
    """

    name: str
    says: str
    noise: float = 0.0
    options: tuple[str, ...] = ()
    pair: bool = False


ROWS = (
    Row("clean", "30,000 uniform samples"),
    *(Row(f"noise-{p}", f"noise of s.d. {p} % of the diagonal", p / 100) for p in (0.1, 0.25, 0.5, 1.0)),
    *(Row(f"outliers-{p}", f"{p} % outliers", 0.0, ("--outliers", str(p / 100))) for p in (1, 5, 10)),
    *(Row(f"points-{n}", f"{n:,} points", 0.0, ("--points", str(n))) for n in (1000, 3000, 10_000)),
    Row("uneven-10", "10 times as dense at one end", 0.0, ("--uneven", "10")),
    *(
        Row(f"missing-{p}", f"{p} % of the surface missing", 0.0, ("--missing", str(p / 100)))
        for p in (5, 15)
    ),
    Row("missing-50", "half of the surface missing: an open sheet", 0.0, ("--missing", "0.5")),
    Row("views-6", "what is seen from six places", 0.0, ("--views", "6")),
    Row("two", "two parts in one cloud", pair=True),
)


def truth_of(data: Path, row: Row, part: str, parts: tuple[str, ...]) -> Mesh:
    """The true surface: the part, or the part and the next one beside it, as large."""
    mesh = read_mesh(data / f"{part}.ply")
    if not row.pair:
        return mesh
    other = read_mesh(data / f"{parts[(parts.index(part) + 1) % len(parts)]}.ply")
    side, place = float(np.ptp(mesh.vertices, axis=0).max()), mesh.vertices.max(axis=0)
    scaled = other.vertices * side / float(np.ptp(other.vertices, axis=0).max())
    beside = scaled - scaled.min(axis=0) + np.array([place[0] + 0.1 * side, *mesh.vertices.min(axis=0)[1:]])
    faces = np.concatenate([mesh.faces, other.faces + len(mesh.vertices)])
    return Mesh(np.concatenate([mesh.vertices, beside]), faces)


def prepare(data: Path, folder: Path, row: Row, parts: tuple[str, ...]) -> None:
    """Truths and damaged clouds of a row, as `bench` wants them."""
    folder.mkdir(parents=True, exist_ok=True)
    for part in parts:
        truth, cloud = folder / f"{part}.ply", folder / f"{part}.cloud.ply"
        if cloud.exists():
            continue
        mesh = truth_of(data, row, part, parts)
        write_mesh(truth, mesh)
        noise = row.noise * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
        options = [*row.options, "--noise", repr(noise)]
        subprocess.run(
            [PROGRAM, "sample", truth, "-o", cloud, *options], check=True, stdout=subprocess.DEVNULL
        )


def carry_out(chosen: argparse.Namespace, rows: list[Row]) -> None:
    """Make and judge what is missing."""
    for row in rows:
        folder = chosen.out / row.name
        sys.stderr.write(f"{row.name} …\n")
        prepare(chosen.data, folder / "parts", row, tuple(chosen.parts))
        command = [PROGRAM, "bench", folder / "parts", "--out", folder / "bench", "--quiet"]
        command += ["--methods", ",".join(chosen.methods), "--seeds", str(chosen.seeds)]
        command += ["--parts", ",".join(chosen.parts), "--jobs", str(chosen.jobs)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        pack(chosen.out, ARCHIVE)


def judged_row(out: Path, row: Row, method: str = METHODS[0]) -> Fits:
    """The fits of a row by one method, ours if none is named."""
    return judged(out / row.name / "bench", method)


def cells(out: Path, row: Row, clean: Fits) -> list[str]:
    """A row of the table."""
    ours, theirs = (judged_row(out, row, method) for method in METHODS)
    both = sorted(set(ours) & set(theirs))
    if not both:
        return [row.says, *["–"] * 9]
    columns = [row.says, str(len(both))]
    for values in (ours, theirs):
        distance = [1000 * values[one]["chamfer"] for one in both]
        spread = statistics.stdev(distance) if len(both) > 1 else 0.0
        columns += [f"{statistics.mean(distance):.3f} ({spread:.3f}), {max(distance):.2f}"]
        columns += [f"{100 * statistics.mean(values[one]['edge_f1'] for one in both):.0f}"]
        columns += [f"{sum(right(values[one]) for one in both)}"]
    ahead = sum(ours[one]["chamfer"] < theirs[one]["chamfer"] for one in both)
    bad = [one for one in both if not right(ours[one]) or ours[one]["chamfer"] > BAD * clean[one]["chamfer"]]
    silent = sum(not ours[one]["said"] for one in bad)
    shut = sum(bool(ours[one]["watertight"]) for one in both)
    return [*columns, f"{ahead}", f"{shut}", f"{len(bad)}, {silent}"]


def table(chosen: argparse.Namespace) -> str:
    """The page."""
    clean = judged_row(chosen.out, ROWS[0])
    fits = {(row.name, *key): one for row in ROWS for key, one in judged_row(chosen.out, row).items()}
    headings = [
        "damage",
        "fits",
        "CD ×10³",
        "edge F1",
        "topology",
        "Poisson's CD ×10³",
        "edge F1",
        "topology",
    ]
    headings += ["ahead of Poisson", "watertight", "bad, of which silent"]
    lines = [
        "# Damaged scans",
        "",
        "- command: `python runs/damage.py DATA OUT`, then `--table`",
        f"- {provenance(fits)}",
        f"- parts: {', '.join(chosen.parts)}; protocol exact-1, against the undamaged truth",
        f"- CD: mean (s.d.), worst; bad: wrong topology, or CD above {BAD:g} times that of the clean scan; "
        "silent: the summary had no doubts",
        "",
        "| " + " | ".join(headings) + " |",
        "|---" + "|---:" * (len(headings) - 1) + "|",
        *("| " + " | ".join(cells(chosen.out, row, clean)) + " |" for row in ROWS),
    ]
    return "\n".join(lines) + "\n"


def options() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA")
    parser.add_argument("out", type=Path, metavar="OUT")
    parser.add_argument("--parts", nargs="+", default=list(PARTS), metavar="PART")
    parser.add_argument("--rows", nargs="+", default=[row.name for row in ROWS], metavar="ROW")
    parser.add_argument("--methods", nargs="+", default=list(METHODS), metavar="METHOD")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="fits side by side")
    parser.add_argument("--table", action="store_true", help="write the table of what there is")
    return parser.parse_args()


def main() -> int:
    """Make what is missing, or tabulate what there is."""
    chosen = options()
    rows = [row for row in ROWS if row.name in chosen.rows]
    unpack(ARCHIVE, chosen.out)
    if chosen.table:
        (ROOT / "results" / "damage.md").write_text(table(chosen), encoding="utf-8")
        sys.stdout.write("results/damage.md\n")
        return 0
    carry_out(chosen, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())

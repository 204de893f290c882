"""All methods on a folder of parts at equal steps and at equal time; goes on where another machine stopped.

    python runs/methods.py DATA OUT [--minutes 60] [--jobs 2] [--shard 1/2] [--times odw-paper@770,…]
    python runs/methods.py DATA OUT --table

DATA holds true meshes and index.csv. Every method has the steps of the standard preset; those of --times, as
`python benchmarks/methods.py --fit` names them, are fitted a second time with the steps that take as long as
`odw` (with --jobs a fit has one thread, and so should that command). `odw-none` has no curvature term.
LEADERS have three seeds. Marching cubes for all, so that fields are compared and not meshers. OUT begins
with what results/methods.tar.xz has, which is written anew after every part, by shard 1 alone. --table
writes results/methods.md, and its overview into the rows of docs/choosing-a-method.md. Run it with the
Python of the environment that has weingarten.
"""

import argparse
import math
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from kept import pack, unpack
from kinds import CHAMFER, TOPOLOGY, Row, index, kinds_table
from renewed import renewed

from weingarten.bench.rendering import markdown
from weingarten.bench.results import Result, results
from weingarten.bench.statistics import figures_of, part_values
from weingarten.bench.store import Store
from weingarten.bench.table import Cell, Table, tables
from weingarten.methods import METHODS
from weingarten.report.provenance import commit, machine, today

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(sys.executable).parent / "weingarten"
ARCHIVE, PAGE = ROOT / "results" / "methods.tar.xz", ROOT / "results" / "methods.md"
DOCUMENT = ROOT / "docs" / "choosing-a-method.md"
LEADERS = ("odw-oriented", "singular-hessian", "smaller-curvature", "odw")
"""The best of the first four parts at one seed, and the baseline; no curvature term is with them."""
BASELINE = "odw"


def part_names(data: Path) -> list[str]:
    """Of the index, every fourth first, then every fourth of the others: any number of them is a mixture."""
    names = [row["id"] for row in index(data)]
    return [name for first in range(4) for name in names[first::4]]


def commands(chosen: argparse.Namespace) -> list[list[str]]:
    """Part by part: all methods, those of other steps, no curvature term; then the leaders' other seeds."""
    every = ",".join([*METHODS, "poisson", *([chosen.times] if chosen.times else [])])
    bench = [str(PROGRAM), "bench", str(chosen.data), "--out", str(chosen.out)]
    shared = ["--sharp", "off", "--shard", chosen.shard, "--quiet", "--jobs", str(chosen.jobs)]
    without = ["--methods", BASELINE, "--schedules", "none"]
    first, leaders = ["--methods", every], ["--methods", ",".join(LEADERS)]
    seeds = ["--seeds", "3"]
    names = part_names(chosen.data)
    pieces = [(part, fits) for part in names for fits in (first, without)]
    pieces += [(part, [*fits, *seeds]) for part in names for fits in (leaders, without)]
    return [[*bench, "--parts", part, *fits, *shared] for part, fits in pieces]


def carry_out(chosen: argparse.Namespace) -> None:
    """Fit until all is done or the time is up; what is known then is kept."""
    end = time.monotonic() + 60.0 * chosen.minutes
    keeper = chosen.shard.startswith("1/")
    for command in commands(chosen):
        left = end - time.monotonic()
        if left <= 0.0:
            break
        try:
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=left)
        except subprocess.TimeoutExpired:
            sys.stderr.write("The time is up; the same command goes on.\n")
        if keeper:
            sys.stderr.write(f"{pack(chosen.out, ARCHIVE):,} files kept in {ARCHIVE.name}\n")


def at_equal_steps(found: list[Result]) -> list[Result]:
    """Those with the preset's steps."""
    return [one for one in found if "@" not in one.contender]


def at_equal_time(found: list[Result]) -> list[Result]:
    """Those with steps of their own, under the method's name, and the methods that need none."""
    own = [replace(one, contender=one.contender.partition("@")[0]) for one in found if "@" in one.contender]
    names = {one.contender for one in own}
    return [one for one in at_equal_steps(found) if one.contender not in names] + own


VIEWS = {"steps": at_equal_steps, "time": at_equal_time}


def whole(found: list[Result]) -> list[Result]:
    """Those of parts that all contenders have had: means over different parts cannot be compared."""
    contenders: dict[str, set[str]] = {}
    for one in found:
        contenders.setdefault(one.part, set()).add(one.contender)
    most = max(map(len, contenders.values()), default=0)
    return [one for one in found if len(contenders[one.part]) == most]


def known(out: Path) -> list[Result]:
    """What has ended, of whole parts; a fit that is begun and not judged has no figures yet."""
    return whole([one for one in results(Store(out)) if one.good or one.failed])


def page(found: list[Result], rows: list[Row]) -> str:
    """The tables of what there is."""
    parts = sorted({one.part for one in found})
    commits = sorted({str(one.fit.get("commit")) for one in found})
    own = sorted({one.contender for one in found if "@" in one.contender})
    several = sorted({one.contender for one in found if one.seed > 0})
    head = [
        "# All methods at equal steps and at equal time",
        "",
        "- command: `python runs/methods.py DATA OUT`, then `--table`",
        f"- fits of commits: {', '.join(commits)}; table of commit {commit(ROOT)}; date: {today()}; "
        f"machine of the table: {machine()}",
        f"- {len(found):,} fits of {len(parts)} parts; preset standard, marching cubes, 30,000 points a part",
        f"- one seed of each contender; more of: {', '.join(several) or 'none yet'}",
        f"- steps in the time of `{BASELINE}`: {', '.join(own)}; all others as many as it has",
        "",
    ]
    head.append(markdown(overview(found)))
    return "\n".join([*head, *(view(name, seen(found), rows) for name, seen in VIEWS.items())])


def overview(found: list[Result]) -> Table:
    """A row a method, equal steps beside equal time, in the order of the former."""
    seen = {when: of(found) for when, of in VIEWS.items()}
    names = dict.fromkeys(one.contender for one in seen["steps"])
    ordered = sorted(names, key=lambda name: middle(seen["steps"], name))
    rows = [(Cell(name), *(cell for of in seen.values() for cell in judged(of, name))) for name in ordered]
    heads = ("exact CD ×10³", "topology right")
    columns = ("", *(f"equal {when}: {head}" for when in VIEWS for head in heads))
    return Table(
        "Overview",
        "Median over the parts (least–greatest), a part's value being the mean over its seeds.",
        columns,
        tuple(rows),
    )


def middle(found: list[Result], name: str) -> float:
    """The median exact CD, infinite where every fit failed."""
    chamfer = part_values(figures_of(found, name, CHAMFER))
    return float(np.median(chamfer)) if len(chamfer) else math.inf


def judged(found: list[Result], name: str) -> list[Cell]:
    """The cells of a method."""
    failed = sum(one.failed for one in found if one.contender == name)
    chamfer = 1e3 * part_values(figures_of(found, name, CHAMFER))
    right = [value for own in figures_of(found, name, TOPOLOGY).values() for value in own.values()]
    spread = "–"
    if len(chamfer):
        spread = f"{np.median(chamfer):.2f} ({chamfer.min():.2f}–{chamfer.max():.2f})"
    hold = f"{sum(right):.0f} of {len(right) + failed}"
    return [Cell(spread), Cell(f"{hold}, {failed} failed" if failed else hold)]


def view(name: str, found: list[Result], rows: list[Row]) -> str:
    """A section: by kind of part, and all tables of a benchmark."""
    shown = [kinds_table([one for one in found if one.good], rows, BASELINE), *tables(found, BASELINE)]
    return "\n".join(
        [f"## At equal {name}\n", *(markdown(table).replace("## ", "### ", 1) for table in shown)]
    )


def main() -> int:
    """Go on, or tabulate."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA")
    parser.add_argument("out", type=Path, metavar="OUT")
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--jobs", type=int, default=1, help="fits at once (default 1)")
    parser.add_argument("--shard", default="1/1", metavar="I/N")
    parser.add_argument("--times", default="", metavar="A@N,B@M")
    parser.add_argument("--table", action="store_true", help="write results/methods.md of what there is")
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    unpack(ARCHIVE, chosen.out)
    if chosen.table:
        found = known(chosen.out)
        PAGE.write_text(page(found, index(chosen.data)), encoding="utf-8")
        text = renewed(DOCUMENT.read_text(encoding="utf-8"), overview(found))
        DOCUMENT.write_text(text, encoding="utf-8")
        sys.stdout.write(f"results/{PAGE.name} and docs/{DOCUMENT.name}\n")
        return 0
    carry_out(chosen)
    return 0


if __name__ == "__main__":
    sys.exit(main())

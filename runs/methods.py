"""All methods on a folder of parts at equal steps and at equal time; goes on where another machine stopped.

    python runs/methods.py DATA OUT [--minutes 60] [--jobs 2] [--shard 1/2] [--times odw-paper@770,…]
    python runs/methods.py DATA OUT --table

DATA holds true meshes and index.csv. Every method has the steps of the standard preset; those of --times, as
`python benchmarks/methods.py --fit` names them, are fitted a second time with the steps that take as long as
`odw` (with --jobs a fit has one thread, and so should that command). LEADERS have three seeds. Marching cubes
for all, so that fields are compared and not meshers. OUT begins with what results/methods.tar.xz has, which
is written anew after every part, by shard 1 alone. --table writes results/methods.md. Run it with the Python
of the environment that has weingarten.
"""

import argparse
import csv
import subprocess
import sys
import time
from pathlib import Path

from kept import pack, unpack

from weingarten.bench.rendering import markdown
from weingarten.bench.results import results
from weingarten.bench.store import Store
from weingarten.bench.table import tables
from weingarten.methods import METHODS
from weingarten.report.provenance import commit, machine, today

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(sys.executable).parent / "weingarten"
ARCHIVE, PAGE = ROOT / "results" / "methods.tar.xz", ROOT / "results" / "methods.md"
LEADERS = ("odw-oriented", "odw", "gaussian", "smaller-curvature")
BASELINE = "odw"


def part_names(data: Path) -> list[str]:
    """Of the index, every fourth first, then every fourth of the others: any number of them is a mixture."""
    with (data / "index.csv").open(newline="", encoding="utf-8") as stream:
        names = [row["id"] for row in csv.DictReader(stream)]
    return [name for first in range(4) for name in names[first::4]]


def commands(chosen: argparse.Namespace) -> list[list[str]]:
    """Part by part: all methods, then those of other steps; then the leaders' other seeds."""
    every = ",".join([*METHODS, "poisson", *([chosen.times] if chosen.times else [])])
    bench = [str(PROGRAM), "bench", str(chosen.data), "--out", str(chosen.out)]
    rounds = [(every, 1), (",".join(LEADERS), 3)]
    shared = ["--sharp", "off", "--baseline", BASELINE, "--shard", chosen.shard, "--quiet"]
    shared += ["--jobs", str(chosen.jobs)]
    return [
        [*bench, "--parts", part, "--methods", methods, "--seeds", str(seeds), *shared]
        for methods, seeds in rounds
        for part in part_names(chosen.data)
    ]


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


def page(out: Path) -> str:
    """The tables of what there is."""
    found = results(Store(out))
    parts = sorted({one.part for one in found})
    commits = sorted({str(one.fit.get("commit")) for one in found})
    head = [
        "# All methods at equal steps and at equal time",
        "",
        "- command: `python runs/methods.py DATA OUT`, then `--table`; NAME@STEPS has the time of `odw`",
        f"- fits of commits: {', '.join(commits)}; table of commit {commit(ROOT)}; date: {today()}; "
        f"machine of the table: {machine()}",
        f"- {len(found):,} fits of {len(parts)} parts; preset standard, marching cubes, 30,000 points a part",
        "",
    ]
    return "\n".join(head) + "\n".join(markdown(table) for table in tables(found, BASELINE))


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
        PAGE.write_text(page(chosen.out), encoding="utf-8")
        sys.stdout.write(f"results/{PAGE.name}\n")
        return 0
    carry_out(chosen)
    return 0


if __name__ == "__main__":
    sys.exit(main())

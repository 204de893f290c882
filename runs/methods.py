"""All methods on a folder of parts at equal steps and at equal time; goes on where another machine stopped.

    python runs/methods.py DATA OUT [--minutes 60] [--jobs 2] [--shard 1/2] [--times odw-paper@770,…]
    python runs/methods.py DATA OUT --table

DATA holds true meshes and index.csv. Every method has the steps of the standard preset; those of --times, as
`python benchmarks/methods.py --fit` names them, are fitted a second time with the steps that take as long as
`odw` (with --jobs a fit has one thread, and so should that command). `odw-none` has no curvature term.
LEADERS have three seeds. Marching cubes for all, so that fields are compared and not meshers. OUT begins
with what results/methods.tar.xz has, which is written anew after every part, by shard 1 alone. --table
writes results/methods.md, and from it the rows of docs/choosing-a-method.md. Run it with the Python of the
environment that has weingarten.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path

from kept import pack, unpack
from kinds import index
from methods_table import BASELINE, document, page, whole

from weingarten.bench.results import Result, results
from weingarten.bench.store import Store
from weingarten.methods import METHODS

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(sys.executable).parent / "weingarten"
ARCHIVE, PAGE = ROOT / "results" / "methods.tar.xz", ROOT / "results" / "methods.md"
DOCUMENT = ROOT / "docs" / "choosing-a-method.md"
LEADERS = ("odw-oriented", "singular-hessian", "smaller-curvature", "odw")
"""The best of the first four parts at one seed, and the baseline; no curvature term is with them."""


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


def known(out: Path) -> list[Result]:
    """What has ended, of whole parts; a fit that is begun and not judged has no figures yet."""
    return whole([one for one in results(Store(out)) if one.good or one.failed])


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
        text = document(DOCUMENT.read_text(encoding="utf-8"), found, index(chosen.data))
        DOCUMENT.write_text(text, encoding="utf-8")
        sys.stdout.write(f"results/{PAGE.name} and docs/{DOCUMENT.name}\n")
        return 0
    carry_out(chosen)
    return 0


if __name__ == "__main__":
    sys.exit(main())

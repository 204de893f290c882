"""Seconds and memory of one step of every method, at the same points, all on the field that each has.

    python benchmarks/methods.py [--points 2000] [--steps 5] [--methods odw,digs]

As `step.py` does it: a process each, steps in turn. The step is the paper preset's first one, at which every
term has its weight: 256 units wide, so many points of each kind, the recipe's terms on the share of them that
they have. Of what a whole fit costs, in which terms come and go, `weingarten bench` has the seconds.
"""

import argparse
import sys

from step import Timing, contend
from table import table

REFERENCE = "odw-paper"
"""Exact off-diagonal Weingarten on all points: what the others are compared with."""


def page(timings: dict[str, Timing], points: int) -> str:
    """The table, the quickest first."""
    import torch

    own = timings[REFERENCE]
    rows = [
        [name, f"{one.seconds:.4f}", f"{one.seconds / own.seconds:.2f}", f"{one.peak:,.0f}"]
        for name, one in sorted(timings.items(), key=lambda item: item[1].seconds)
    ]
    head = f"{points:,} points of each kind, {torch.get_num_threads()} threads, torch {torch.__version__}\n"
    return head + table(["method", "s/step", f"× {REFERENCE}", "peak MiB"], rows)


def main() -> None:
    """Parse, measure, write the table."""
    from weingarten.methods import METHODS

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=2000, help="of each kind (default 2000)")
    parser.add_argument("--steps", type=int, default=5, help="timed, beside one to warm up (default 5)")
    parser.add_argument("--methods", default=",".join(METHODS), help="names (default: all)")
    arguments = parser.parse_args()
    names = list(dict.fromkeys([REFERENCE, *arguments.methods.split(",")]))
    sys.stdout.write(page(contend(names, arguments.points, arguments.steps), arguments.points))


if __name__ == "__main__":
    main()

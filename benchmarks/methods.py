"""Seconds and memory of every method's step, at the same points, each on the field that it has.

    python benchmarks/methods.py [--points 2000] [--steps 5] [--methods odw,digs]
    python benchmarks/methods.py --fit [--steps 5] [--methods odw,digs]

As `step.py` does it: a process each, steps in turn. The step is the paper preset's first one, at which every
term has its weight: 256 units wide, so many points of each kind, the recipe's terms on the share of them that
they have. With --fit it is the mean over a whole fit of the standard preset, in which terms come and go; and
from that, the steps in which each method takes as long as the first one named, as `weingarten bench
--methods` has them: a second benchmark at equal time.
"""

import argparse
import sys

from contenders import FIT_OF
from step import Timing, contend
from table import table

NEAR = 0.1
"""A method this near to the first one's time is compared with it as it is."""


def page(timings: dict[str, Timing], reference: str) -> str:
    """The table, the quickest first."""
    own = timings[reference]
    rows = [
        [name, f"{one.seconds:.4f}", f"{one.seconds / own.seconds:.2f}", f"{one.peak:,.0f}"]
        for name, one in sorted(timings.items(), key=lambda item: item[1].seconds)
    ]
    return table(["method", "s/step", f"× {reference}", "peak MiB"], rows)


def equal_time(timings: dict[str, Timing], reference: str, steps: int) -> str:
    """METHOD@STEPS of all that are not NEAR the reference."""
    ratios = {name: timings[reference].seconds / one.seconds for name, one in timings.items()}
    far = {name: ratio for name, ratio in ratios.items() if abs(ratio - 1.0) > NEAR}
    return ",".join(f"{name}@{round(steps * ratio)}" for name, ratio in far.items())


def main() -> None:
    """Parse, measure, write the table."""
    import torch

    from weingarten.methods import METHODS
    from weingarten.settings import resolve

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=2000, help="of each kind (default 2000)")
    parser.add_argument("--steps", type=int, default=5, help="timed, beside one to warm up (default 5)")
    parser.add_argument("--methods", default=",".join(METHODS), help="names (default: all)")
    parser.add_argument("--fit", action="store_true", help="of a whole standard fit; --points is not read")
    arguments = parser.parse_args()
    names = list(dict.fromkeys(arguments.methods.split(",")))
    shown = [FIT_OF + name for name in names] if arguments.fit else names
    measured = contend(shown, arguments.points, arguments.steps)
    timings = {name.removeprefix(FIT_OF): timing for name, timing in measured.items()}
    kind = "a standard fit" if arguments.fit else f"{arguments.points:,} points of each kind"
    sys.stdout.write(f"{kind}, {torch.get_num_threads()} threads, torch {torch.__version__}\n")
    sys.stdout.write(page(timings, names[0]))
    if arguments.fit:
        steps = resolve("standard").steps
        sys.stdout.write(f"at equal time: {equal_time(timings, names[0], steps)}\n")


if __name__ == "__main__":
    main()

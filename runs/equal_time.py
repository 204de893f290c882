"""How many steps every method may take to fit as long as the baseline: for a second benchmark at equal time.

    weingarten bench DATA --methods odw,gaussian,digs --out OUT                     # equal steps
    weingarten bench DATA --methods $(python runs/equal_time.py OUT) --out OUT      # equal time, beside them

From the seconds of fitting in OUT, the median over the parts of their ratio to the baseline's; without
preparing and extracting, which take as long for any method. Prints METHOD@STEPS for every one that is more
than a tenth quicker or slower. Run it with the Python of the environment that weingarten is installed in.
"""

import argparse
import statistics
import sys
from pathlib import Path

from weingarten.bench.results import Result, results
from weingarten.bench.store import Store

NEAR = 0.1
"""A method this near to the baseline's time is compared as it is."""


def fitting(found: list[Result], name: str) -> dict[tuple[str, int], float]:
    """Seconds of fitting by part and seed."""
    return {(one.part, one.seed): one.fit["phases"]["fitting"] for one in found if one.contender == name}


def equal_steps(found: list[Result], name: str, baseline: str) -> int:
    """Steps in which it takes as long as the baseline. Raises ValueError where no part has both."""
    own, other = fitting(found, name), fitting(found, baseline)
    shared = own.keys() & other.keys()
    if not shared:
        raise ValueError(f"{name} and {baseline} share no part")
    steps = next(one.fit["settings"]["steps"] for one in found if one.contender == name)
    return round(steps * statistics.median(other[key] / own[key] for key in shared))


def main() -> None:
    """Read, divide, print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=Path, help="folder of a benchmark")
    parser.add_argument("--baseline", default="odw", help="method whose time all get (default odw)")
    arguments = parser.parse_args()
    found = [
        one for one in results(Store(arguments.out)) if one.good and one.fit["settings"]["kind"] == "neural"
    ]
    names = dict.fromkeys(one.contender for one in found if "@" not in one.contender)
    steps = {name: equal_steps(found, name, arguments.baseline) for name in names}
    full = found[0].fit["settings"]["steps"]
    chosen = [f"{name}@{own}" for name, own in steps.items() if abs(own / full - 1.0) > NEAR]
    sys.stdout.write(",".join(chosen) + "\n")


if __name__ == "__main__":
    main()

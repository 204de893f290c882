"""Parts a second, fitted one after the other and all together as one ensemble.

    python benchmarks/batched.py [--parts 4] [--steps 60] [--device cpu]

The parts are the bundled ones in turn, 10,000 points each, each time with other points. The preset is
standard with so many steps; timed are the fits alone, not what comes before and after them, and after a short
fit of either kind to warm up.
"""

import argparse
import itertools
import sys
import time

import torch
from table import table

from weingarten.cli.memory import keep_freed_memory
from weingarten.device import DEVICES, chosen_device
from weingarten.fit.loop import Loop, run
from weingarten.samples.parts import PARTS, sample_part
from weingarten.settings import Settings, resolve
from weingarten.start import Start, loop_of
from weingarten.together import joint

POINTS, WARMING_STEPS = 10_000, 6


def starts(count: int, settings: Settings, device: torch.device) -> list[Start]:
    """Parts before their first step."""
    names = itertools.islice(itertools.cycle(PARTS), count)
    clouds = [sample_part(name, POINTS, seed) for seed, name in enumerate(names)]
    return [Start.of(cloud, settings, device) for cloud in clouds]


def seconds(loop: Loop) -> float:
    """Of a whole fit."""
    started = time.perf_counter()
    run(loop, lambda *_: None)
    return time.perf_counter() - started


def fitted(parts: list[Start], settings: Settings) -> tuple[float, float]:
    """Seconds of all fits: together, and one after the other."""
    ensemble = joint(settings, parts)
    loops = [loop_of(settings, part.field, part.draws, part.generator) for part in parts]
    return seconds(ensemble), sum(map(seconds, loops))


def main() -> None:
    """Parse, fit, write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--parts", type=int, default=4, help="how many (default 4)")
    parser.add_argument("--steps", type=int, default=60, help="of each fit (default 60)")
    parser.add_argument("--device", choices=DEVICES, default="cpu", help="where (default cpu)")
    arguments = parser.parse_args()
    keep_freed_memory()
    device = chosen_device(arguments.device)
    for steps in (WARMING_STEPS, arguments.steps):
        settings = resolve("standard", steps=steps)
        together, alone = fitted(starts(arguments.parts, settings, device), settings)
    speeds = [arguments.parts / taken for taken in (alone, together)]
    cells = [f"{alone:.2f}", f"{together:.2f}", f"{alone / together:.2f}"]
    rows = [["seconds", *cells], ["parts/s", *(f"{speed:.3f}" for speed in speeds), ""]]
    heading = f"{arguments.parts} parts, {arguments.steps} steps each, on {device.type}"
    sys.stdout.write(f"{heading}\n{table(['', 'one by one', 'together', 'ratio'], rows)}")


if __name__ == "__main__":
    main()

"""Seconds and memory of one optimisation step: this engine, its stencil, and plain autograd.

    python benchmarks/step.py [--points 20000] [--steps 3] [--baseline]

Each contender runs in a process of its own, so that its peak memory is its own; they take their steps in
turn, so that whatever else the machine does falls on all of them alike. The engine's arithmetic is counted
from its own plan of a step (fit.loop: forward passes of one point by the order of its jet); the limit is what
it takes at the fastest float32 matrix product seen on this machine.
"""

import argparse
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from statistics import median

from contenders import CONTENDERS, HEAVY, contender
from process import own_peak
from table import table

RACE = ("engine", "stencil", "baseline", "hessian")
ARITHMETIC = {"engine": "paper", "first": "standard, first step", "last": "standard, last step"}


@dataclass(frozen=True)
class Timing:
    """Of one contender: median seconds a step, peak memory in MiB, counted arithmetic in GFLOP."""

    seconds: float
    peak: float
    gigaflop: float


def serve(name: str, points: int) -> None:
    """Answer every line on standard input with a step's seconds, the peak in MiB and the step's GFLOP."""
    from weingarten.cli.memory import keep_freed_memory

    keep_freed_memory()
    stepper = contender(name).stepper(points)
    with stepper.crew:
        for _ in sys.stdin:
            started = time.perf_counter()
            for _ in range(stepper.turn):
                stepper.step()
            seconds = (time.perf_counter() - started) / stepper.turn
            sys.stdout.write(f"{seconds} {own_peak()} {stepper.gigaflop}\n")
            sys.stdout.flush()


@contextmanager
def serving(name: str, points: int) -> Iterator[subprocess.Popen[str]]:
    """A contender's process; it ends with the block."""
    command = [sys.executable, __file__, "--points", str(points), "--serve", name]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.communicate()


def asked(name: str, process: subprocess.Popen[str]) -> Timing:
    """One turn of a contender."""
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write("step\n")
    process.stdin.flush()
    answer = process.stdout.readline().split()
    if len(answer) != 3:
        raise SystemExit(f"The process of {name} ended early, with code {process.wait()}.")
    return Timing(*map(float, answer))


def contend(names: list[str], points: int, steps: int) -> dict[str, Timing]:
    """The timing of each; the first turn is not counted."""
    turns: list[dict[str, Timing]] = []
    with ExitStack() as stack:
        processes = {name: stack.enter_context(serving(name, points)) for name in names}
        for _ in range(steps + 1):
            turns.append({name: asked(name, process) for name, process in processes.items()})
    return {
        name: Timing(median(turn[name].seconds for turn in turns[1:]), last.peak, last.gigaflop)
        for name, last in turns[-1].items()
    }


def race(timings: dict[str, Timing], speed: float) -> str:
    """The paper step's table, with each against the engine and against the limit."""
    engine = timings["engine"]
    limit = engine.gigaflop / speed
    rows: list[list[str]] = []
    for name in filter(timings.__contains__, RACE):
        timing = timings[name]
        cells = ratios(timing.seconds, engine.seconds, limit)
        rows.append([CONTENDERS[name].label, *cells, f"{timing.peak:,.0f}"])
    rows.append(["arithmetic limit", *ratios(limit, engine.seconds, limit), ""])
    return table(["", "s/step", "× engine", "× limit", "peak MiB"], rows)


def ratios(seconds: float, engine: float, limit: float) -> list[str]:
    """A time, and what it is times the engine's and times the limit."""
    return [f"{seconds:.4f}", f"{seconds / engine:.2f}", f"{seconds / limit:.2f}"]


def arithmetic(timings: dict[str, Timing], speed: float) -> str:
    """How much of the fastest product's speed the engine's steps reach."""
    rows: list[list[str]] = []
    for name, label in ARITHMETIC.items():
        timing = timings[name]
        reached = timing.gigaflop / timing.seconds
        cells = [f"{timing.seconds:.4f}", f"{timing.gigaflop:.2f}", f"{reached:.0f}"]
        rows.append([label, *cells, f"{100 * reached / speed:.0f}", f"{timing.peak:,.0f}"])
    return table(["this engine", "s/step", "GFLOP", "GFLOP/s", "% of fastest", "peak MiB"], rows)


def page(timings: dict[str, Timing], points: int) -> str:
    """Both tables and what they are measured against."""
    import torch
    from peak import matrix_peak

    speed, where = matrix_peak()
    return (
        f"One paper step, {points:,} points of each kind, {torch.get_num_threads()} threads, "
        f"torch {torch.__version__}\n{race(timings, speed)}\n{arithmetic(timings, speed)}\n"
        f"fastest float32 product: {speed:.0f} GFLOP/s ({where})\n"
    )


def main() -> None:
    """Parse, measure, write the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--points", type=int, default=20_000, help="points of each kind of a paper step (default 20000)"
    )
    parser.add_argument("--steps", type=int, default=3, help="turns timed, beside one to warm up (default 3)")
    parser.add_argument("--baseline", action="store_true", help="time plain autograd too (many gigabytes)")
    parser.add_argument("--serve", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.serve:
        serve(arguments.serve, arguments.points)
        return
    names = [name for name in CONTENDERS if name not in HEAVY or arguments.baseline]
    sys.stdout.write(page(contend(names, arguments.points, arguments.steps), arguments.points))


if __name__ == "__main__":
    main()

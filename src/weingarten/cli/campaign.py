"""What the verbs `bench` and `reproduce` share: options of a benchmark, and its carrying out."""

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli.crowd import add_options as add_crowd
from weingarten.cli.crowd import crowd_of
from weingarten.cli.switch import SWITCH
from weingarten.errors import OptionError

if TYPE_CHECKING:
    from weingarten.bench.contender import Contender
    from weingarten.bench.table import Table
    from weingarten.settings import Settings


def add_options(verb: argparse.ArgumentParser, seeds: int) -> None:
    """What every benchmark can be told. seeds: how many, by default."""
    add_fitting(verb)
    verb.add_argument(
        "--seeds", type=int, default=seeds, metavar="K", help="fits of each kind, seeds 0 to K-1"
    )
    verb.add_argument("--shard", default="1/1", metavar="I/N", help="only the I-th of N shares of the fits")


def add_fitting(verb: argparse.ArgumentParser) -> None:
    """How each fit is made. What calls this sets `seeds` and `shard` some other way."""
    verb.add_argument("--parts", metavar="A,B", help="only these parts")
    verb.add_argument("--preset", default="standard", metavar="NAME", help="standard, fine or paper")
    verb.add_argument("--steps", type=int, metavar="N", help="optimisation steps (default: preset's)")
    verb.add_argument("--points-per-step", type=int, metavar="N", help="of each kind (default: preset's)")
    verb.add_argument(
        "--resolution", type=int, metavar="N", help="cells along the longest side (default: preset's)"
    )
    verb.add_argument("--sharp", choices=SWITCH, help="vertices on sharp edges or not (default: preset's)")
    verb.add_argument("--points", type=int, default=30_000, metavar="N", help="points of each sampled scan")
    verb.add_argument("--device", default="auto", metavar="NAME", help="auto, cpu, cuda or mps")
    verb.add_argument(
        "--together", type=int, default=1, metavar="N", help="parts fitted at once as one ensemble, for GPUs"
    )
    verb.add_argument("--retry", action="store_true", help="try again what failed before")
    verb.add_argument("--oracle", action="store_true", help="stop early by the truth, as the paper does")
    verb.add_argument("--quiet", action="store_true", help="no progress")
    add_crowd(verb, alone=True)


def budget(arguments: argparse.Namespace, method: str | None = None, sharp: bool | None = None) -> "Settings":
    """The preset with what is to differ from it. Raises OptionError.

    method: instead of the preset's. sharp: where the arguments say nothing of it.
    """
    from weingarten.settings import resolve

    return resolve(
        preset=arguments.preset,
        method=method,
        steps=arguments.steps,
        points=arguments.points_per_step,
        resolution=arguments.resolution,
        sharp=SWITCH.get(arguments.sharp, sharp),
    )


def carried_out(
    arguments: argparse.Namespace, data: Path, contenders: Sequence["Contender"], out: Path, baseline: str
) -> "list[Table]":
    """Make and judge every fit; the tables. Raises a WeingartenError that names the option at fault."""
    from weingarten.bench.campaign import carry_out
    from weingarten.bench.parts import parts_in
    from weingarten.bench.runner import Plan
    from weingarten.bench.store import Store
    from weingarten.report.provenance import machine, origin

    for name, value, most in (
        ("--seeds", arguments.seeds, 1000),
        ("--points", arguments.points, 10**8),
        ("--together", arguments.together, 1000),
    ):
        if not 1 <= value <= most:
            raise OptionError(f"{name} must be between 1 and {most:,}; got {value}.")
    parts, part = parts_in(data, names(arguments.parts)), share(arguments.shard)
    crowd = crowd_of(arguments, alone=True)
    with crowd.working(), watching(arguments.quiet) as watcher:
        plan = Plan(
            Store(out),
            parts,
            contenders,
            arguments.seeds,
            arguments.points,
            crowd.device(arguments.device),
            origin(machine(crowd.threads.count)),
            part,
        )
        return carry_out(plan, watcher, crowd, baseline, arguments.retry, arguments.together)


def watching(quiet: bool):
    """Whoever tells a person how far things are: lines that pass on a terminal, lines that stay elsewhere."""
    from weingarten.cli.watching import Lines, Quiet, Status

    return Quiet() if quiet else Status() if sys.stderr.isatty() else Lines()


def names(text: str | None) -> list[str]:
    """The names in a list with commas."""
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def share(text: str) -> tuple[int, int]:
    """i and n of "i/n"."""
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    index, count = (int(found[1]), int(found[2])) if found else (0, 0)
    if not 1 <= index <= count:
        raise OptionError(f"--shard is written I/N with I from 1 to N, for example 2/4; got {text!r}.")
    return index, count

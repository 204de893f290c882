"""Who does many fits: processes of this machine or a Ray cluster, as the command line has it."""

import argparse
from typing import TYPE_CHECKING

from weingarten.errors import OptionError

if TYPE_CHECKING:
    from weingarten.many.runner import Crowd

ROOM = 2 * 2**30
"""Bytes of memory for each fit, where it is not said how many are made at once."""
MOST = 1024


def add_options(group: argparse._ActionsContainer, alone: bool) -> None:
    """What chooses it. alone: as in `crowd_of`."""
    jobs = "1, so that seconds can be compared" if alone else "one a core that has 2 GB; on a GPU 1"
    cpus = "all; 1 with --ray" if alone else "1"
    group.add_argument(
        "--jobs", type=int, metavar="N", help=f"fits at once on this machine (default: {jobs})"
    )
    group.add_argument(
        "--cpus-per-fit",
        type=int,
        metavar="N",
        help="threads of each fit, and cores kept for it; the last digits of figures depend on it "
        f"(default: {cpus}; with --jobs, what cores there are for each)",
    )
    group.add_argument(
        "--ray", metavar="ADDRESS", help="fit on a Ray cluster: HOST:PORT, auto, or local for this machine"
    )
    group.add_argument(
        "--gpus-per-fit",
        type=float,
        metavar="X",
        help="with --ray: share of a GPU for each fit (default: 0.25 on cuda, 1 with bench --together)",
    )


def crowd_of(arguments: argparse.Namespace, alone: bool) -> "Crowd":
    """It. alone: one fit at a time with all cores, unless told otherwise; else one on each core.

    Raises OptionError for options that are out of range or do not go together.
    """
    from weingarten.cli.memory import keep_freed_memory
    from weingarten.many.cluster import GPU_SHARE, Ray
    from weingarten.many.threads import Threads
    from weingarten.many.workers import Workers

    check(arguments)
    if arguments.ray is None:
        jobs, cpus = at_once(arguments, alone)
        return Workers(keep_freed_memory, jobs, Threads(cpus))
    share = 1.0 if getattr(arguments, "together", 1) > 1 else GPU_SHARE
    return Ray(keep_freed_memory, arguments.ray, arguments.cpus_per_fit or 1, arguments.gpus_per_fit, share)


def check(arguments: argparse.Namespace) -> None:
    """Raise OptionError where something is out of range, or does not go with something else."""
    for name, value in (("--jobs", arguments.jobs), ("--cpus-per-fit", arguments.cpus_per_fit)):
        if value is not None and not 1 <= value <= MOST:
            raise OptionError(f"{name} must be between 1 and {MOST:,}; got {value}.")
    gpus = arguments.gpus_per_fit
    if gpus is not None and not 0 <= gpus <= MOST:
        raise OptionError(f"--gpus-per-fit must be between 0 and {MOST:,}; got {gpus:g}.")
    if gpus is not None and arguments.ray is None:
        raise OptionError("--gpus-per-fit is for --ray; on one machine --jobs says how many share a GPU.")
    if arguments.jobs is not None and arguments.ray is not None:
        raise OptionError("--jobs is for one machine; with --ray the cluster has as many fits as have room.")


def at_once(arguments: argparse.Namespace, alone: bool) -> tuple[int, int | None]:
    """How many fits, and how many threads for each; None leaves that to torch."""
    import psutil

    from weingarten.device import chosen_device
    from weingarten.many.threads import usable_cores

    cores, jobs, cpus = usable_cores(), arguments.jobs, arguments.cpus_per_fit
    if jobs is not None:
        return jobs, cpus or max(1, cores // jobs)
    if alone or chosen_device(arguments.device).type != "cpu":
        return 1, cpus
    cpus = cpus or 1
    return max(1, min(cores // cpus, psutil.virtual_memory().available // ROOM)), cpus

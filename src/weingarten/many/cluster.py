"""Machines of a Ray cluster: fits packed by cores or shares of a GPU, done again where a machine is lost.

A machine gets a job with its files and sends back the files that it made, which are written here: it has to
see none of this one's folders, and all that there is of a job is in its folder, here. What a machine had of
an unfinished fit is lost with it. Ray's own retries are off, so that it is known how often a job was given
away.
"""

import functools
import os
import socket
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from typing import Any

from weingarten.device import DEVICES
from weingarten.errors import InputError, OptionError
from weingarten.extras import required
from weingarten.many.job import FAILED, failure
from weingarten.many.parcel import Files, Parcel, unpack
from weingarten.many.runner import POLL, Batch, Watcher
from weingarten.many.threads import Threads, usable_cores
from weingarten.many.workers import perform

LOCAL = "local"
"""The address of a cluster of this machine alone, which lasts as long as the command."""
TRIES = 4
"""How often a job is given to a machine, at most; the last is lost as a failure."""
AHEAD = 2
"""Jobs handed out for each that the cluster can do at once, so that no machine waits for the next."""
GPU_SHARE = 0.25
"""Of a GPU, for each fit, by default."""


class Ray:
    """A cluster at an address. setup: called before each batch.

    cpus: cores reserved for each batch, and its threads. gpus: GPUs for each, from 0; None: `share` on CUDA.
    """

    def __init__(
        self,
        setup: Callable[[], object],
        address: str,
        cpus: int = 1,
        gpus: float | None = None,
        share: float = GPU_SHARE,
    ) -> None:
        self.setup, self.address, self.cpus, self.gpus, self.share = setup, address, cpus, gpus, share
        self.threads = Threads(cpus)
        self.ray: Any = None

    @contextmanager
    def working(self) -> Iterator[None]:
        """See Crowd. Raises MissingExtraError without Ray, OptionError where no cluster answers."""
        self.ray = required("ray", "--ray needs", "ray")
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        cores = {"num_cpus": usable_cores(), "include_dashboard": False} if self.address == LOCAL else {}
        try:
            self.ray.init(address=self.address, logging_level="error", log_to_driver=False, **cores)
        except (ConnectionError, OSError, RuntimeError, ValueError) as error:
            raise OptionError(
                f"--ray {self.address}: no cluster can be used there ({first_line(error)}); "
                "see `ray start --help`, or use --ray local."
            ) from error
        try:
            yield
        finally:
            self.ray.shutdown()

    def device(self, name: str) -> str:
        """See Crowd; auto is CUDA where the cluster has any GPU."""
        if name not in DEVICES:
            raise OptionError(f"There is no device {name!r}; choose one of {', '.join(DEVICES)}.")
        if name == "auto":
            name = "cuda" if self.ray.cluster_resources().get("GPU") else "cpu"
        if self.gpus is None:
            self.gpus = self.share if name == "cuda" else 0.0
        return name

    def perform(self, batches: Iterable[Batch], watcher: Watcher) -> None:
        """See Crowd."""
        self.check_room(watcher)
        waiting = iter(batches)
        running: dict[Any, tuple[Batch, int]] = {}
        while True:
            while len(running) < AHEAD * self.places() and (batch := next(waiting, None)) is not None:
                watcher.begin(batch)
                self.give(batch, 1, running, watcher)
            if not running:
                return
            ended, _ = self.ray.wait(list(running), num_returns=1, timeout=POLL)
            for reference in ended:
                batch, tries = running.pop(reference)
                if self.concluded(reference, batch, tries, watcher):
                    watcher.end(batch)
                else:
                    self.give(batch, tries + 1, running, watcher)
            if not ended:
                watcher.look(next(iter(running.values()))[0], None)

    def give(self, batch: Batch, tries: int, running: dict[Any, tuple[Batch, int]], watcher: Watcher) -> None:
        """Have a machine do a batch, which is among the running ones then; or note why that cannot be."""
        try:
            parcel = Parcel.of(batch)
        except InputError as error:
            note_failure(batch, failure(error))
            watcher.end(batch)
        else:
            reference = self.task.remote(parcel, self.setup, self.threads, version("weingarten"))
            running[reference] = batch, tries

    @functools.cached_property
    def task(self) -> Any:
        """`done` with what it needs. A process that serves it begins with its variables."""
        wanted = {"num_cpus": self.cpus, "num_gpus": self.gpus or 0.0, "max_retries": 0}
        return self.ray.remote(**wanted, runtime_env={"env_vars": self.threads.environment})(done)

    def concluded(self, reference: Any, batch: Batch, tries: int, watcher: Watcher) -> bool:
        """Write what was sent back, or note a failure; False where the batch is to be given away again."""
        errors = self.ray.exceptions
        try:
            files = self.ray.get(reference)
        except errors.RayTaskError as error:
            cause = error.cause if isinstance(error.cause, Exception) else error
            note_failure(batch, failure(cause))
        except errors.RayError as error:
            why = first_line(error)
            watcher.note(f"{batch[0].name}: lost with its machine at try {tries} of {TRIES} ({why}).")
            if tries < TRIES:
                return False
            said = f"It was lost with its machine {tries} times, the last time by: {why}."
            note_failure(batch, {"status": FAILED, "error": said})
        else:
            unpack(files, batch[0].root)
        return True

    def places(self) -> int:
        """How many batches the cluster can do at once, as it is now; at least one."""
        there = self.ray.cluster_resources()
        places = there.get("CPU", 0) / self.cpus
        if self.gpus:
            places = min(places, there.get("GPU", 0) / self.gpus)
        return max(1, int(places))

    def check_room(self, watcher: Watcher) -> None:
        """A note where no machine is large enough for a batch: Ray would wait for one without a word."""
        wanted = {"CPU": self.cpus, "GPU": self.gpus or 0}
        machines = [one["Resources"] for one in self.ray.nodes() if one["Alive"]]
        if not any(all(one.get(key, 0) >= value for key, value in wanted.items()) for one in machines):
            asked = f"{self.cpus} cores" + (f" and {self.gpus:g} GPUs" if self.gpus else "")
            watcher.note(f"No machine of the cluster has {asked} for a fit; waiting for one.")


def done(parcel: Parcel, setup: Callable[[], object], threads: Threads, wanted: str) -> Files:
    """On the machine: the jobs of a parcel, and the files that they leave. Raises OptionError.

    wanted: the version of this package that the others have.
    """
    if (own := version("weingarten")) != wanted:
        raise OptionError(
            f"{socket.gethostname()} has weingarten {own}, where the command was given it is {wanted}; "
            "install the same version on all machines, and repeat the command with --retry."
        )
    threads.take()
    setup()
    return parcel.done(perform)


def note_failure(batch: Batch, failed: dict[str, Any]) -> None:
    """Of all its jobs."""
    for job in batch:
        job.note_failure(failed)


def first_line(error: Exception) -> str:
    """Of what an error says, or its name."""
    lines = str(error).strip().splitlines()
    return lines[0].strip().rstrip(".") if lines else type(error).__name__

"""How many threads a process may use: figures depend on it, so it is said, not found.

Sums in single precision add up in another order on another number of threads. Neighbours in a KDTree are
looked for by all cores whatever is said here; they are the same.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import torch

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""What libraries look at when they are loaded."""


@dataclass(frozen=True)
class Threads:
    """count: of each process; None leaves it to the libraries and to the environment."""

    count: int | None = None

    @property
    def environment(self) -> dict[str, str]:
        """Variables that a process has to begin with."""
        return {} if self.count is None else dict.fromkeys(VARIABLES, str(self.count))

    @contextmanager
    def inherited(self) -> Iterator[None]:
        """Processes that begin within have the variables; this one's are put back afterwards."""
        before = {name: os.environ.get(name) for name in self.environment}
        os.environ.update(self.environment)
        try:
            yield
        finally:
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value

    def take(self) -> None:
        """In the process, before its first fit."""
        if self.count is not None:
            torch.set_num_threads(self.count)


def usable_cores() -> int:
    """Cores that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

"""How long a fit will take and how much memory it will need, from trial passes of its own steps."""

import time
from dataclasses import dataclass

import psutil

from weingarten.fit.loop import Loop
from weingarten.fit.pieces import cost

NODES_PER_CELL_SQUARED = 9.5
"""Field evaluations of an extraction over resolution², measured on CAD parts at 256 and 512."""

BYTES_PER_CELL_SQUARED = 3_000
"""Memory of an extraction over resolution², measured likewise."""


@dataclass(frozen=True)
class Estimate:
    """Seconds and bytes of a whole fit, for the person waiting."""

    step: float
    training: float
    extraction: float
    memory: int

    @property
    def total(self) -> float:
        """Seconds from now to the mesh."""
        return self.training + self.extraction


def estimate(loop: Loop, resolution: int) -> Estimate:
    """Time the passes of the first and the last step (after one to warm up) and leave the loop as it was."""
    state = loop.generator.get_state()
    with loop.crew:
        seconds = [timed(loop, progress) for progress in (0.0, 0.0, 1.0)][1:]
    passes = [cost(loop.plan(loop.outline(progress))) for progress in (0.0, 1.0)]
    loop.generator.set_state(state)
    loop.field.zero_grad()
    step = sum(seconds) / 2.0
    # a weight that ends at 0 may leave nothing to do in the last step
    forward = max(seconds) / max(*passes, 1)
    return Estimate(
        step=step,
        training=step * (loop.steps - loop.step),
        extraction=forward * NODES_PER_CELL_SQUARED * resolution**2,
        memory=resident_memory() + BYTES_PER_CELL_SQUARED * resolution**2,
    )


def timed(loop: Loop, progress: float) -> float:
    """Seconds of one pass."""
    started = time.perf_counter()
    loop.accumulate(progress)
    return time.perf_counter() - started


def resident_memory() -> int:
    """Memory that this process holds now, bytes."""
    return psutil.Process().memory_info().rss

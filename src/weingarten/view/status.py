"""How far a fit is, from what its run folder holds: in a word for the page, and in a sentence for people."""

from dataclasses import dataclass

from weingarten.duration import duration

QUIET = 30.0
"""Seconds without a checkpoint after which a fit may have been killed; or so many steps' time."""
QUIET_STEPS = 20.0

RUNNING, ENDED, SILENT = "running", "ended", "silent"


@dataclass(frozen=True)
class Status:
    """kind: RUNNING, ENDED or SILENT. step, of: taken and planned. text: a sentence."""

    kind: str
    step: int
    of: int
    text: str


def status(step: int, of: int, ended: bool, silent: float, each: float) -> Status:
    """Of a run whose checkpoint is of `step`.

    ended: whether there is a summary of these steps. silent: seconds since the checkpoint was written. each:
    seconds a step takes.
    """
    far = f"Step {step:,} of {of:,}"
    if ended:
        return Status(ENDED, step, of, f"Fitted, {of:,} steps." if step >= of else f"{far}; stopped there.")
    if silent > max(QUIET, QUIET_STEPS * each):
        return Status(
            SILENT, step, of, f"{far}; nothing new for {duration(silent)}, it may have been killed."
        )
    if step >= of:
        return Status(RUNNING, step, of, f"{far}; extracting the surface.")
    left = f", about {duration(each * (of - step))} left" if each > 0.0 else ""
    return Status(RUNNING, step, of, f"{far}{left}.")

"""A command as the system counts it: its standard output, wall seconds and peak memory in MiB.

Linux counts the caller's own peak as the command's, too: call this from a process that is small.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass

PER_MEBIBYTE = 1024**2 if sys.platform == "darwin" else 1024
"""What the system counts memory in: bytes or KiB."""


@dataclass(frozen=True)
class Outcome:
    """text: what the command wrote. seconds: wall time. peak: resident memory at most, MiB."""

    text: str
    seconds: float
    peak: float


def measured(command: list[str]) -> Outcome:
    """Run a command to its end. Raises SystemExit with the end of its errors where it fails."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        started = time.perf_counter()
        process = subprocess.Popen(command, stdout=output, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - started
        process.returncode = os.waitstatus_to_exitcode(status)
        texts = []
        for stream in (output, errors):
            stream.seek(0)
            texts.append(stream.read().decode())
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command)} ended with code {process.returncode}:\n{texts[1][-2000:]}")
    return Outcome(texts[0], seconds, usage.ru_maxrss / PER_MEBIBYTE)


def own_peak() -> float:
    """This process's peak memory so far, MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / PER_MEBIBYTE

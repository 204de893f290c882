"""Reads every bad file in a process that may not take much memory, and says what became of each: JSON.

Run by itself: `python reading_in_bounds.py FOLDER`. The limit is what the process has when it begins, and
MEMORY bytes more. Every input has SECONDS.
"""

import json
import os
import resource
import signal
import sys
import time
from pathlib import Path

import psutil
from bad_files import every_bad_file
from files import every_valid_file, read

from weingarten.errors import WeingartenError

MEMORY = 300 << 20
SECONDS = 10


class TooSlowError(BaseException):
    """No Exception, or the readers' gate would take it for a bad file."""


def too_slow(*_: object) -> None:
    """The alarm."""
    raise TooSlowError


def outcome(reader: str, path: Path) -> str:
    """What reading the file does: "" for a good answer or a sentence of ours, else what went wrong."""
    signal.setitimer(signal.ITIMER_REAL, SECONDS)
    try:
        read(reader, path)
    except WeingartenError as error:
        return "took too much memory" if "into memory" in str(error) else ""
    except BaseException as error:
        return f"{type(error).__name__}: {error}"[:200]
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    return ""


def bounded(memory: int) -> None:
    """From here on, this process may have so much more memory."""
    limit = psutil.Process().memory_info().vms + memory
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    signal.signal(signal.SIGALRM, too_slow)


def main() -> None:
    """All of them."""
    folder = Path(sys.argv[1])
    for valid in every_valid_file().values():
        (folder / valid.name).write_bytes(valid.content)
        read(valid.reader, folder / valid.name)
    bad = list(every_bad_file())
    bounded(MEMORY)
    wrong, slowest, before = {}, (0.0, ""), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for label, reader, name, content in bad:
        path = folder / name
        path.write_bytes(content)
        started = time.perf_counter()
        if found := outcome(reader, path):
            wrong[label] = found
        slowest = max(slowest, (time.perf_counter() - started, label))
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024
    json.dump({"files": len(bad), "wrong": wrong, "slowest": slowest, "grown": grown}, sys.stdout)
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()

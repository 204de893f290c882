"""The command in a process of its own, as a user's shell would run it."""

import atexit
import json
import os
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from functools import cache
from pathlib import Path

PROGRAM = "from weingarten.cli.main import command; command()"
SMALL = ["--points-per-step", "200", "--resolution", "24"]


class Started:
    """The command, running, in a fork of one process: what subprocess.Popen has, of which stderr is a pipe.

    alone: in a process group of its own.
    """

    def __init__(self, *words: object, alone: bool = False) -> None:
        order = {
            "words": list(map(str, words)),
            "alone": alone,
            "folder": str(Path.cwd()),
            "environment": one_threaded(),
        }
        self.stdout = tempfile.TemporaryFile("w+", encoding="utf-8")  # noqa: SIM115
        self.report, theirs = socket.socketpair()
        ours, err = os.pipe()
        self.stderr = os.fdopen(ours, encoding="utf-8")
        with theirs, os.fdopen(err, "wb"), tempfile.TemporaryFile("w+", encoding="utf-8") as asked:
            json.dump(order, asked)
            asked.seek(0)
            files = [asked.fileno(), self.stdout.fileno(), err, theirs.fileno()]
            socket.send_fds(nursery(), [b"1"], files)
        self.pid = int.from_bytes(self.report.recv(8), "little")
        self.returncode: int | None = None

    def poll(self) -> int | None:
        """The exit code, if it has ended."""
        if self.returncode is None and select.select([self.report], [], [], 0)[0]:
            self.wait()
        return self.returncode

    def wait(self) -> int:
        """The exit code, once it has ended."""
        if self.returncode is None:
            self.returncode = int.from_bytes(self.report.recv(8), "little", signed=True)
            self.report.close()
        return self.returncode

    def communicate(self, timeout: float = 300) -> tuple[str, str]:
        """Standard output and error to their ends; killed after so many seconds."""
        late = threading.Timer(timeout, self.kill)
        late.start()
        with self.stderr, self.stdout:
            err = self.stderr.read()
            self.wait()
            late.cancel()
            self.stdout.seek(0)
            return self.stdout.read(), err

    def send_signal(self, number: int) -> None:
        """To the command's process."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        """Signal 9."""
        self.send_signal(signal.SIGKILL)


@cache
def nursery() -> socket.socket:
    """Where to ask for a command; the process behind it ends with this one."""
    asking, answering = socket.socketpair()
    program = Path(__file__).parent / "nursery.py"
    words = [sys.executable, "-c", program.read_text(encoding="utf-8"), str(answering.fileno())]
    process = subprocess.Popen(words, pass_fds=[answering.fileno()], env=one_threaded())
    answering.close()

    def end() -> None:
        asking.close()
        process.wait()

    atexit.register(end)
    return asking


def one_threaded() -> dict[str, str]:
    """This process's environment, but for OpenMP's threads: a fork has none of those it may wait for."""
    return {**os.environ, "OMP_NUM_THREADS": "1"}


def started_anew(*words: object) -> subprocess.Popen:
    """The command, running, by an interpreter of its own; its standard output and error are pipes."""
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=one_threaded(),
    )


def run(*words: object) -> tuple[int, str, str]:
    """Exit code, standard output, standard error."""
    process = Started(*words)
    out, err = process.communicate()
    return process.wait(), out, err


def run_anew(*words: object) -> tuple[int, str, str]:
    """The same by an interpreter of its own, whose hashes are others."""
    process = started_anew(*words)
    out, err = process.communicate(timeout=300)
    return process.returncode, out, err


def temporaries(folder: Path) -> list[Path]:
    """Half-written files left in a folder."""
    return [path for path in folder.iterdir() if path.name.startswith(".")]

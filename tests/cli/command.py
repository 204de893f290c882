"""The command as a subprocess, as a user's shell would run it."""

import os
import subprocess
import sys
from pathlib import Path

PROGRAM = "from weingarten.cli.main import command; command()"
SMALL = ["--points-per-step", "200", "--resolution", "24"]


def started(*words: object, **options) -> subprocess.Popen:
    """The command, running; its standard error is a pipe."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        **options,
    )


def run(*words: object) -> tuple[int, str, str]:
    """Exit code, standard output, standard error."""
    process = started(*words)
    out, err = process.communicate(timeout=300)
    return process.returncode, out, err


def temporaries(folder: Path) -> list[Path]:
    """Half-written files left in a folder."""
    return [path for path in folder.iterdir() if path.name.startswith(".")]

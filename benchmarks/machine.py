"""Where and when figures were taken: processor, threads, versions, commit, date."""

import datetime
import os
import platform
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def machine() -> str:
    """Processor, cores, threads and versions."""
    code = "import torch; print(torch.__version__, torch.get_num_threads())"
    torch, threads = subprocess.check_output([sys.executable, "-c", code], text=True).split()
    python = platform.python_version()
    return f"{processor()}, {os.cpu_count()} cores, {threads} threads, torch {torch}, Python {python}"


def processor() -> str:
    """The processor's name."""
    info = Path("/proc/cpuinfo")
    text = info.read_text(encoding="utf-8") if info.exists() else ""
    names = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def commit() -> str:
    """The checked-out commit, and whether the source differs from it."""
    git = ["git", "-C", str(ROOT)]
    try:
        name = subprocess.check_output([*git, "rev-parse", "--short=12", "HEAD"], text=True).strip()
        changes = subprocess.check_output([*git, "status", "--porcelain", "--", "src"], text=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return name + (" with changes" if changes else "")


def today() -> datetime.date:
    """Today, in universal time."""
    return datetime.datetime.now(datetime.UTC).date()

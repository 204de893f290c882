"""Where and when figures were taken: processor, threads, versions, commit, date."""

import datetime
import os
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path


def machine(threads: int | None = None) -> str:
    """Processor, cores, threads, GPU and versions; by default this process's threads, else those said."""
    import torch

    count = torch.get_num_threads() if threads is None else threads
    plural = "" if count == 1 else "s"
    gpu = "CUDA" if torch.cuda.is_available() else "no GPU"
    versions = f"torch {torch.__version__}, Python {platform.python_version()}"
    return f"{processor()}, {os.cpu_count()} cores, {count} thread{plural}, {gpu}, {versions}"


def processor() -> str:
    """The processor's name."""
    info = Path("/proc/cpuinfo")
    text = info.read_text(encoding="utf-8") if info.exists() else ""
    names = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def commit(repository: Path) -> str:
    """The checked-out commit, and whether the source differs from it; "unknown" without git."""
    git = ["git", "-C", str(repository)]
    try:
        name = said([*git, "rev-parse", "--short=12", "HEAD"]).strip()
        changes = said([*git, "status", "--porcelain", "--", "src"])
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return name + (" with changes" if changes else "")


def said(command: list[str]) -> str:
    """What a command prints. Raises CalledProcessError where it fails, OSError where there is no such."""
    return subprocess.check_output(command, text=True, stderr=subprocess.DEVNULL)


def origin(place: str) -> dict[str, str]:
    """Version, commit, machine and date, for a record. The commit is that of the package's own checkout.

    place: the machine, as the above describes it.
    """
    package = Path(__file__).resolve().parent.parent
    root = package.parent.parent
    own = (root / "pyproject.toml").exists() and package.parent.name == "src"
    return {
        "version": version("weingarten"),
        "commit": commit(root) if own else "unknown",
        "machine": place,
        "date": str(today()),
    }


def today() -> datetime.date:
    """Today, in universal time."""
    return datetime.datetime.now(datetime.UTC).date()

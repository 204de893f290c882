"""The extras of pyproject.toml, and an environment for subprocesses that has none of them."""

import os
import tomllib
from pathlib import Path

from weingarten.cli.doctor import EXTRAS

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
DEVELOPING = {"dev", "docs"}
"""Extras of those who work on the package; no verb needs them."""

MODULES = sorted({module for modules in EXTRAS.values() for module in modules})
WITHOUT = Path(__file__).parent / "without"


def environment(*path: Path, blocked: bool = True) -> dict[str, str]:
    """This process's, with `path` alone on Python's path; blocked: whether MODULES are not to be found."""
    places = os.pathsep.join(map(str, (WITHOUT, *path)))
    names = ",".join(MODULES) if blocked else ""
    return {**os.environ, "PYTHONPATH": places, "WITHOUT": names, "OMP_NUM_THREADS": "1"}

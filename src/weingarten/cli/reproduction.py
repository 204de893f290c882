"""What `reproduce tables` and `reproduce figures` share: who takes part, and where all goes."""

import argparse
import importlib.util
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli import campaign

if TYPE_CHECKING:
    from weingarten.reproduce.tables import Entrants

METHODS = {"standard": "odw", "fine": "odw"}
"""By preset, without the normals that the paper has not; nor has it vertices on sharp edges."""


def add_options(verb: argparse.ArgumentParser) -> None:
    """Beside those of a benchmark."""
    verb.add_argument("--out", type=Path, metavar="DIR", help="where all goes (default: reproduced-PRESET)")
    verb.add_argument("--weight", type=float, default=10.0, metavar="W", help="greatest one of a schedule")


def folder(arguments: argparse.Namespace) -> Path:
    """Where all goes."""
    return arguments.out or Path(f"reproduced-{arguments.preset}")


def entrants(arguments: argparse.Namespace) -> "Entrants":
    """Who takes part; a note where screened Poisson cannot. Raises OptionError."""
    from weingarten.reproduce.tables import Entrants

    poisson = importlib.util.find_spec("gpytoolbox") is not None
    if not poisson:
        sys.stderr.write('Note: screened Poisson is left out; for it, pip install "weingarten[bench]".\n')
    budget = campaign.budget(arguments, METHODS.get(arguments.preset), sharp=False)
    return Entrants.of(budget, arguments.weight, arguments.oracle, poisson)

"""What the page needs beyond the base install, asked for when it is needed."""

import importlib
from types import ModuleType

from weingarten.errors import MissingExtraError

MODULES = ("jinja2", "matplotlib", "fast_simplification")


def required(name: str) -> ModuleType:
    """A module of the extra `report`. Raises MissingExtraError, which says how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise MissingExtraError(
            f'The report needs {name}; install it with: pip install "weingarten[report]"'
        ) from error


def check() -> None:
    """Raise MissingExtraError unless all of it is there; ask before long work."""
    for name in MODULES:
        required(name)

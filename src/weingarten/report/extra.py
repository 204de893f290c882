"""What the page needs beyond the base install, asked for when it is needed."""

from types import ModuleType

from weingarten import extras

MODULES = ("jinja2", "matplotlib", "fast_simplification")


def required(name: str) -> ModuleType:
    """A module of the extra `report`. Raises MissingExtraError, which says how to install it."""
    return extras.required(name, "The report needs", "report")


def check() -> None:
    """Raise MissingExtraError unless all of it is there; ask before long work."""
    for name in MODULES:
        required(name)

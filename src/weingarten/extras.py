"""Modules of the package's extras, imported when they are needed."""

import importlib
from types import ModuleType

from weingarten.errors import MissingExtraError


def required(module: str, what: str, extra: str) -> ModuleType:
    """An optional module, imported.

    what: the beginning of the error's sentence, "The report needs". extra: of this package, that has it.
    Raises MissingExtraError, which says how to install it.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            f'{what} {module}; install it with: pip install "weingarten[{extra}]"'
        ) from error

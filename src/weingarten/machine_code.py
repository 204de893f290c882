"""Functions that numba compiles to machine code when they are first called."""

from typing import Any

from numba import njit


def machine_code(fastmath: bool | set[str]) -> Any:
    """njit without the interpreter's lock, kept on disk where there is a place for it, else compiled anew."""

    def decorated(function: Any) -> Any:
        options = {"nogil": True, "fastmath": fastmath, "error_model": "numpy"}
        try:
            return njit(cache=True, **options)(function)
        except (RuntimeError, OSError):
            return njit(**options)(function)

    return decorated

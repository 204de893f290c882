"""Functions that numba compiles to machine code when they are first called."""

import os
from pathlib import Path
from typing import Any

from numba import config, njit

LOCATION = ("CACHE_DIR", "CACHE_LOCATOR_CLASSES")


def machine_code(fastmath: bool | set[str]) -> Any:
    """njit without the interpreter's lock, kept on disk where there is a place for it, else compiled anew."""

    def decorated(function: Any) -> Any:
        options = {"nogil": True, "fastmath": fastmath, "error_model": "numpy"}
        # numba takes settings from a .numba_config.yaml in the current folder, which may be a run folder from
        # elsewhere; a cache named there would have its pickled code run
        for name in LOCATION:
            setattr(config, name, os.environ.get(f"NUMBA_{name}", ""))
        try:
            return njit(cache=True, **options)(function)
        except (RuntimeError, OSError):
            return njit(**options)(function)

    return decorated


def is_kept(function: Any) -> bool:
    """Whether machine code of a function lies on disk, so that its first call need not compile."""
    folder = function.stats.cache_path
    return folder is not None and any(Path(folder).glob(f"*.{function.__name__}-*.nbi"))

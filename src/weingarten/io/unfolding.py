"""How much a file may become in memory: archives unpack, and scenes repeat a part as often as they like.

A few bytes can say "this, a thousand times, a thousand times". What a reader would make of a file is counted
before anything is made, and compared with the size of the file.
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import TypeVar

Key = TypeVar("Key", bound=Hashable)

ALWAYS_FINE = 64 << 20
MOST_EXPANSION = 200
INSTANCE = 1 << 12
"""Bytes that a place of a part in a scene takes up, beside the part."""
_ENDLESS = 1 << 62
"""Sizes are not counted further."""


def check_unfolded(unfolded: int, size: int, what: str) -> None:
    """Raise ValueError for more than 64 MiB that are also over 200 times the `size` bytes of the file."""
    if unfolded > max(ALWAYS_FINE, MOST_EXPANSION * size):
        raise ValueError(f"it {what} to {unfolded} bytes, {unfolded / max(size, 1):.0f} times its size")


def unfolded_size(own: Mapping[Key, int], parts: Mapping[Key, Sequence[Key]], roots: Iterable[Key]) -> int:
    """Bytes of all that is placed below the roots: U(k) = own(k) + INSTANCE + Σ U(part of k), over the roots.

    ValueError where something is a part of itself. Every key is visited once, however often it is placed.
    """
    total: dict[Key, int] = {}
    open_keys: set[Key] = set()
    roots = list(roots)
    stack = list(roots)
    while stack:
        key = stack[-1]
        if key in total:
            stack.pop()
            continue
        waiting = [part for part in parts.get(key, ()) if part not in total]
        if not waiting:
            below = sum(total[part] for part in parts.get(key, ()))
            total[key] = min(own.get(key, 0) + INSTANCE + below, _ENDLESS)
            open_keys.discard(key)
            stack.pop()
            continue
        if key in open_keys:
            raise ValueError(f"its object {key} is a part of itself")
        open_keys.add(key)
        stack += waiting
    return sum(total[root] for root in roots)

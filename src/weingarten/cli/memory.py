"""A setting of the C library that belongs to the command, not to the library: it is the process's own."""

import ctypes
import sys

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
LARGEST_KEPT = 32 << 20
"""glibc's own upper limit."""


def keep_freed_memory() -> None:
    """Let glibc keep freed megabytes for the next step; to get them back costs a page fault per 4 kB.

    Does nothing where the C library is another one.
    """
    if not sys.platform.startswith("linux"):
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_MMAP_THRESHOLD, LARGEST_KEPT)
        mallopt(M_TRIM_THRESHOLD, 1 << 30)

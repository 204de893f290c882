"""A run folder is written by one process at a time."""

import errno
import os
import platform
from collections.abc import Iterator
from contextlib import contextmanager
from fcntl import LOCK_EX, LOCK_NB, flock
from pathlib import Path

from weingarten.errors import BusyError, OutputError

NAME = "lock"
LOCKLESS = (errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP)
"""What file systems without locks say."""


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold a folder's lock while the body runs. Raises BusyError where somebody else does, saying who.

    The kernel takes a lock from a process that dies, so that none is ever stale; the file that it is laid on
    says who has it, and goes with it. Only writers ask for it: whoever reads finds whole files.
    """
    path = folder / NAME
    try:
        handle = locked(path)
    except BlockingIOError as error:
        raise BusyError(
            f"The run folder {folder} is in use by {holder(path)}; wait for it, or choose another folder."
        ) from error
    except OSError as error:
        raise OutputError(f"{path} could not be written: {error.strerror}.") from error
    try:
        os.ftruncate(handle, 0)
        os.pwrite(handle, f"process {os.getpid()} on {platform.node()}".encode(), 0)
        yield
    finally:
        path.unlink(missing_ok=True)
        os.close(handle)


def locked(path: Path) -> int:
    """A handle of the file at `path`, made if need be, with the lock. Raises BlockingIOError."""
    while True:
        # a link that somebody put there would have another file emptied
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK, 0o666)
        try:
            flock(handle, LOCK_EX | LOCK_NB)
            # the last holder may have removed the file between the two calls
            if path.exists() and os.path.samestat(os.fstat(handle), path.stat()):
                return handle
        except OSError as error:
            if error.errno in LOCKLESS:
                return handle
            os.close(handle)
            raise
        os.close(handle)


def holder(path: Path) -> str:
    """Who has the lock, as far as the file says."""
    try:
        return path.read_text(encoding="utf-8", errors="replace")[:200] or "another process"
    except OSError:
        return "another process"

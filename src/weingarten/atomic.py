"""Files appear whole or not at all: write to a temporary name beside the target, then rename."""

import os
import secrets
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from weingarten.errors import OutputError

STEM = 60
"""Characters of a name that its temporary name keeps: the whole of it might be too long."""


def check_writable(path: Path) -> None:
    """Raise OutputError unless a file can be made at `path`; ask before long work, not after it."""
    folder = path.parent
    if not folder.is_dir():
        raise OutputError(f"The folder {folder} for {path.name} does not exist; create it first.")
    if path.is_dir():
        raise OutputError(f"{path} is a folder; give a file name to write to.")
    if not os.access(folder, os.W_OK):
        raise OutputError(f"The folder {folder} is not writable; choose another place for {path.name}.")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary name (same folder, same extension); rename it to `path` if the body succeeds.

    On any failure the temporary file is removed and a file already at `path` stays as it was.
    Raises OutputError when the folder is missing or read-only, or the disk is full.
    """
    check_writable(path)
    temporary = path.with_name(f".{path.stem[:STEM]}-{secrets.token_hex(4)}{path.suffix}")
    try:
        # as any new file, with the permissions that the umask leaves; never one that is there
        os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield temporary
        with temporary.open("rb") as stream:
            os.fsync(stream.fileno())
        temporary.replace(path)
    except OSError as error:
        raise OutputError(f"{path} could not be written: {error.strerror or error}.") from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def remove_leftovers(folder: Path, names: Iterable[str]) -> None:
    """Remove what a killed process left of files with these names, where no other process writes them."""
    for name in names:
        path = Path(name)
        for temporary in folder.glob(f".{path.stem[:STEM]}-????????{path.suffix}"):
            temporary.unlink(missing_ok=True)

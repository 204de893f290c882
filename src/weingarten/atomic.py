"""Files appear whole or not at all: write to a temporary name beside the target, then rename."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from weingarten.errors import OutputError


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
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        yield temporary
        with temporary.open("rb") as stream:
            os.fsync(stream.fileno())
        temporary.replace(path)
    except OSError as error:
        raise OutputError(f"{path} could not be written: {error.strerror or error}.") from error
    finally:
        temporary.unlink(missing_ok=True)

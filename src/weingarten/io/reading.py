"""One gate for every file that comes in: whatever a malformed file causes leaves as one InputError."""

import warnings
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from weingarten.errors import InputError, WeingartenError

AGAIN = "export it again or check its extension"


def check_readable(path: Path, known: Collection[str]) -> None:
    """Raise InputError unless `path` is a regular file that is not empty, with an extension among `known`.

    A pipe would be waited for, and a device may never end; a link is what it points to.
    """
    try:
        found = path.stat()
    except FileNotFoundError as error:
        raise InputError(f"{path} does not exist; check the name.") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be reached ({_reason(error)}); check the name.") from error
    if S_ISDIR(found.st_mode):
        raise InputError(f"{path} is a folder; give the name of a file in it.")
    if path.suffix.lower() not in known:
        raise InputError(f"{path} has an unknown extension; known are {' '.join(sorted(known))}.")
    if not S_ISREG(found.st_mode):
        raise InputError(f"{path} is a pipe or a device; give the name of a file.")
    if found.st_size == 0:
        raise InputError(f"{path} is empty; export it again.")


@contextmanager
def reading(
    path: Path, failure: type[WeingartenError] = InputError, kind: str = "", remedy: str = AGAIN
) -> Iterator[None]:
    """Run a reader: its warnings are silenced, and any exception becomes a `failure` naming `path`.

    The parsers below, trimesh's among them, meet arbitrary bytes and raise nearly anything: ValueError,
    KeyError, struct.error, BadZipFile, RecursionError. All of them mean the same to the user.

    kind: what the file is not, by default what its extension says; remedy: what to do about it.
    """
    kind = kind or path.suffix.lower().removeprefix(".").upper()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except WeingartenError:
        raise
    except MemoryError as error:
        raise failure(f"{path} does not fit into memory; thin it out first.") from error
    except OSError as error:
        raise failure(f"{path} cannot be read ({_reason(error)}); check the file.") from error
    except Exception as error:
        raise failure(f"{path} cannot be read as {kind} ({_reason(error)}); {remedy}.") from error


def _reason(error: Exception) -> str:
    """What an exception says, on one line, without its full stop and at most 160 characters long."""
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    line = " ".join(text.split()).rstrip(".")
    return (line if len(line) <= 160 else line[:157] + "...") or type(error).__name__

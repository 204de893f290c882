"""What is known of a job, as JSON objects in files of its folder."""

import json
from pathlib import Path
from typing import Any

from weingarten.atomic import replacing
from weingarten.errors import OutputError
from weingarten.io.reading import check_readable, reading


def make_folder(path: Path) -> None:
    """Raise OutputError where it cannot be made."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"The folder {path} cannot be made: {error.strerror}.") from error


def read(path: Path) -> dict[str, Any]:
    """A JSON object; empty where there is no file. Raises InputError for anything else."""
    if not path.exists():
        return {}
    check_readable(path, [".json"])
    with reading(path, remedy="delete it, and it is made again"):
        values = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(values, dict):
            raise ValueError("it holds no object")
        return values


def write(path: Path, values: dict[str, Any]) -> None:
    """Write a JSON object, whole or not at all. ValueError for NaN and infinities."""
    text = json.dumps(values, indent=1, allow_nan=False)
    with replacing(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")

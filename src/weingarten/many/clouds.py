"""The clouds of a folder, and a name for each that no other has."""

from collections import Counter
from pathlib import Path

from weingarten.errors import InputError
from weingarten.io.points import POINT_READERS
from weingarten.many.records import read


def clouds_in(folder: Path, out: Path) -> dict[str, Path]:
    """Files by name, in order: every file with a cloud's extension, but hidden ones.

    The name is the file's without its extension; with it where two would have one name, also where they
    differ in large and small letters alone, which is no difference to some disks. A file whose fit lies in
    `out` under its short name keeps that, whatever has come to the folder since.
    Raises InputError for a folder without clouds.
    """
    files = sorted(path for path in folder.iterdir() if is_cloud(path))
    if not files:
        raise InputError(f"{folder} holds no cloud; it should hold files {', '.join(POINT_READERS)}.")
    names = {path: path.stem for path in files}
    while twice := clashing(names):
        for path in twice:
            names[path] = path.name
    for path, name in names.items():
        if name != path.stem and read(out / path.stem / "fit.json").get("cloud") == path.name:
            names[path] = path.stem
    return {name: path for path, name in names.items()}


def is_cloud(path: Path) -> bool:
    """By its name."""
    return path.suffix.lower() in POINT_READERS and not path.name.startswith(".") and path.is_file()


def clashing(names: dict[Path, str]) -> list[Path]:
    """The files that could have a longer name, and should."""
    counts = Counter(name.casefold() for name in names.values())
    return [path for path, name in names.items() if counts[name.casefold()] > 1 and name != path.name]

"""The kinds of folders that a page can be made of, told by what is in them."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from weingarten.errors import InputError
from weingarten.report.page import Watcher, write_page
from weingarten.report.run.page import write_run_page
from weingarten.report.run.source import CONFIG


@dataclass(frozen=True)
class Kind:
    """holds: what only such a folder has. maker: what makes one.

    write: writes the page of a folder, and answers what it is about.
    """

    name: str
    holds: str
    maker: str
    write: Callable[[Path, Path, Watcher], object]


KINDS = (
    Kind("a benchmark", "fits", "weingarten bench --out", write_page),
    Kind("a run", CONFIG, "weingarten fit --run", lambda folder, path, watcher: write_run_page(folder, path)),
)


def kind_of(folder: Path) -> Kind:
    """The kind of a folder. Raises InputError where there is none, or it is of no kind."""
    makers = " or ".join(f"`{kind.maker} {folder}`" for kind in KINDS)
    if not folder.is_dir():
        raise InputError(f"There is no folder {folder}; {makers} makes one.")
    found = next((kind for kind in KINDS if (folder / kind.holds).exists()), None)
    if found is None:
        kinds = ", nor ".join(f"{kind.name}’s folder, for it has no {kind.holds}" for kind in KINDS)
        raise InputError(f"{folder} is not {kinds}; {makers} makes one.")
    return found

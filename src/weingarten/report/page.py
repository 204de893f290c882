"""The page about a benchmark: one HTML file that needs nothing else, neither a network nor another file.

The same folder gives the same bytes. Everything that is said is from the folder and the truths that its
records name; nothing is fitted or judged here.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from weingarten.atomic import check_writable
from weingarten.bench.job import DONE
from weingarten.bench.results import Result, results
from weingarten.bench.store import Store
from weingarten.bench.table import CEILING, tables
from weingarten.errors import InputError
from weingarten.report import curves, extra, gallery, template
from weingarten.report.distributions import distributions
from weingarten.report.facts import facts
from weingarten.report.heat import ANCHORS
from weingarten.report.plot import COLOURS
from weingarten.report.scene import triangles_each
from weingarten.report.side_by_side import part_views
from weingarten.report.viewing import viewing

LONG = 40
"""Tables with more rows are folded up."""


class Watcher:
    """Whoever watches a page being made; the default sees nothing."""

    def part(self, name: str, number: int, of: int) -> None:
        """The pictures of a part are made. number: how many parts have theirs."""


@dataclass(frozen=True)
class Made:
    """What the page is about, and how large it is."""

    fits: int
    parts: int
    contenders: int
    size: int

    def __str__(self) -> str:
        """For a person."""
        counts = f"{self.fits} fits, {self.contenders} contenders, {self.parts} parts"
        return f"{counts}, {self.size / 1e6:.1f} MB"


def write_page(folder: Path, path: Path, watcher: Watcher) -> Made:
    """Write the page about a benchmark's folder.

    Raises InputError for a folder that is no benchmark's or holds no finished fit, OutputError where the page
    cannot be written, MissingExtraError without the extra `report`.
    """
    extra.check()
    store, found = opened(folder)
    check_writable(path)
    size = template.write(path, page(store, found, watcher))
    return Made(len(found), len(parts_of(found)), len(names_of(found)), size)


def opened(folder: Path) -> tuple[Store, list[Result]]:
    """A benchmark's folder and its fits, at least one of them with a mesh. Raises InputError."""
    if not folder.is_dir():
        raise InputError(f"There is no folder {folder}; name the --out of a `weingarten bench`.")
    if not (folder / "fits").is_dir():
        raise InputError(
            f"{folder} is no benchmark's folder, for it has no fits/; `weingarten bench` makes one."
        )
    found = results(Store(folder))
    if not any(one.fit.get("status") == DONE for one in found):
        raise InputError(f"{folder} holds no finished fit yet; run its `weingarten bench` to the end of one.")
    return Store(folder), found


def parts_of(found: Sequence[Result]) -> list[str]:
    """The parts in order."""
    return list(dict.fromkeys(one.part for one in found))


def names_of(found: Sequence[Result]) -> list[str]:
    """The contenders in alphabetical order, which gives each its colour."""
    return sorted({one.contender for one in found})


def page(store: Store, found: Sequence[Result], watcher: Watcher) -> str:
    """The page as text."""
    parts, names = parts_of(found), names_of(found)
    triangles = triangles_each(len(parts), len(names))
    views = []
    for view in part_views(store, found, parts, names, triangles):
        views.append(view)
        watcher.part(view.name, len(views), len(parts))
    every = curves.all_curves(found, names)
    settings, scenes = viewing(views)
    return template.rendered(
        "benchmark.html",
        title=store.path.resolve().name,
        facts=facts(found, parts, names),
        names=names,
        colours={name: number % COLOURS for number, name in enumerate(names)},
        tables=tables(found),
        pinned=CEILING,
        long=LONG,
        distributions=distributions(found, names),
        losses=curves.loss_plots(every),
        thin=curves.THIN,
        terms=curves.term_plots(every),
        without=[name for name in names if name not in [one.name for one in every]],
        views=views,
        drawn=gallery.DRAWN,
        triangles=triangles,
        anchors=ANCHORS,
        viewing=settings,
        scenes=scenes,
    )

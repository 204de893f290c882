"""A benchmark of all methods by part: the default, the recipe's other rows, Poisson, the published rows.

The published rows are those that are fitted a second time with steps of their own, at equal time.
"""

import numpy as np
from kinds import CHAMFER, TOPOLOGY

from weingarten.bench.results import Result
from weingarten.bench.statistics import Figures, figures_of
from weingarten.bench.table import Cell, Table

DEFAULT, POISSON = "odw-oriented", "poisson"
COLUMNS = ("", f"`{DEFAULT}`", "its place", "other rows of the recipe", f"`{POISSON}`", "best published row")
CAPTION = "Exact CD ×10³, mean over the seeds; in brackets how many fits have components and genus right."


def parts_table(found: list[Result]) -> Table:
    """Of the parts in their order by name."""
    names = list(dict.fromkeys(one.contender for one in found))
    chamfers = {name: figures_of(found, name, CHAMFER) for name in names}
    rights = {name: figures_of(found, name, TOPOLOGY) for name in names}
    parts = sorted({one.part for one in found})
    rows = [row(part, values_of(chamfers, part), rights) for part in parts]
    return Table("By part", CAPTION, COLUMNS, tuple(rows))


def values_of(chamfers: dict[str, Figures], part: str) -> dict[str, float]:
    """Of every contender that has a mesh of the part, best first."""
    values = {
        name: 1e3 * float(np.mean(list(own[part].values()))) for name, own in chamfers.items() if part in own
    }
    return dict(sorted(values.items(), key=lambda item: item[1]))


def published_names(names: list[str]) -> set[str]:
    """Those with steps of their own, and the same with the preset's."""
    return {name for own in names if "@" in own for name in (own, own.partition("@")[0])}


def row(part: str, values: dict[str, float], rights: dict[str, Figures]) -> tuple[Cell, ...]:
    """A part's cells."""
    published = published_names(list(rights))
    others = {name: value for name, value in values.items() if name not in {*published, DEFAULT, POISSON}}
    first = next((name for name in values if name in published), None)
    several = [*others.values()]
    return (
        Cell(part),
        Cell(judged(values, rights, part, DEFAULT)),
        Cell(f"{1 + list(values).index(DEFAULT)} of {len(values)}" if DEFAULT in values else "–"),
        Cell(f"{several[0]:.3f}–{several[-1]:.3f} ({right(rights, part, list(others))})" if several else "–"),
        Cell(judged(values, rights, part, POISSON)),
        Cell("–" if first is None else f"`{first}` {judged(values, rights, part, first)}"),
    )


def judged(values: dict[str, float], rights: dict[str, Figures], part: str, name: str) -> str:
    """A contender's value and how often it is right."""
    return f"{values[name]:.3f} ({right(rights, part, [name])})" if name in values else "–"


def right(rights: dict[str, Figures], part: str, names: list[str]) -> str:
    """How many of the contenders' fits have components and genus right."""
    known = [value for name in names for value in rights[name].get(part, {}).values()]
    return f"{sum(known):.0f} of {len(known)}"

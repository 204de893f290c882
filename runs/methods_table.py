"""The tables of all methods at equal steps and at equal time: a page of results, and a document's rows."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from by_part import parts_table
from kinds import CHAMFER, TOPOLOGY, Row, kinds_table
from renewed import renewed

from weingarten.bench.rendering import markdown
from weingarten.bench.results import Result
from weingarten.bench.statistics import figures_of, part_values
from weingarten.bench.table import Cell, Table, tables
from weingarten.report.provenance import commit, machine, today

ROOT = Path(__file__).resolve().parent.parent
BASELINE = "odw"


def at_equal_steps(found: list[Result]) -> list[Result]:
    """Those with the preset's steps."""
    return [one for one in found if "@" not in one.contender]


def at_equal_time(found: list[Result]) -> list[Result]:
    """Those with steps of their own, under the method's name, and the methods that need none."""
    own = [replace(one, contender=one.contender.partition("@")[0]) for one in found if "@" in one.contender]
    names = {one.contender for one in own}
    return [one for one in at_equal_steps(found) if one.contender not in names] + own


VIEWS = {"steps": at_equal_steps, "time": at_equal_time}


def whole(found: list[Result]) -> list[Result]:
    """Those of parts that all contenders have had: means over different parts cannot be compared."""
    contenders: dict[str, set[str]] = {}
    for one in found:
        contenders.setdefault(one.part, set()).add(one.contender)
    most = max(map(len, contenders.values()), default=0)
    return [one for one in found if len(contenders[one.part]) == most]


def page(found: list[Result], rows: list[Row]) -> str:
    """The tables of what there is."""
    parts = sorted({one.part for one in found})
    commits = sorted({str(one.fit.get("commit")) for one in found})
    own = sorted({one.contender for one in found if "@" in one.contender})
    several = sorted({one.contender for one in found if one.seed > 0})
    head = [
        "# All methods at equal steps and at equal time",
        "",
        "- command: `python runs/methods.py DATA OUT`, then `--table`",
        f"- fits of commits: {', '.join(commits)}; table of commit {commit(ROOT)}; date: {today()}; "
        f"machine of the table: {machine()}",
        f"- {len(found):,} fits of {len(parts)} parts; preset standard, marching cubes, 30,000 points a part",
        f"- one seed of each contender; more of: {', '.join(several) or 'none yet'}",
        f"- steps in the time of `{BASELINE}`: {', '.join(own)}; all others as many as it has",
        "",
    ]
    head += [markdown(table) for table in (overview(found), parts_table(found))]
    return "\n".join([*head, *(view(name, seen(found), rows) for name, seen in VIEWS.items())])


def document(text: str, found: list[Result], rows: list[Row]) -> str:
    """A document for a reader, with the figures that there are now."""
    good = [one for one in at_equal_steps(found) if one.good]
    text = renewed(text, "method", overview(found), last=2)
    text = renewed(text, "over `odw`", kinds_table(good, rows, BASELINE), last=0)
    return renewed(text, "part", parts_table(found), last=1)


def overview(found: list[Result]) -> Table:
    """A row a method, equal steps beside equal time, in the order of the former."""
    seen = {when: of(found) for when, of in VIEWS.items()}
    names = dict.fromkeys(one.contender for one in seen["steps"])
    ordered = sorted(names, key=lambda name: middle(seen["steps"], name))
    rows = [(Cell(name), *(cell for of in seen.values() for cell in judged(of, name))) for name in ordered]
    heads = ("exact CD ×10³", "topology right")
    columns = ("", *(f"equal {when}: {head}" for when in VIEWS for head in heads))
    return Table(
        "Overview",
        "Median over the parts (least–greatest), a part's value being the mean over its seeds.",
        columns,
        tuple(rows),
    )


def middle(found: list[Result], name: str) -> float:
    """The median exact CD, infinite where every fit failed."""
    chamfer = part_values(figures_of(found, name, CHAMFER))
    return float(np.median(chamfer)) if len(chamfer) else math.inf


def judged(found: list[Result], name: str) -> list[Cell]:
    """The cells of a method."""
    failed = sum(one.failed for one in found if one.contender == name)
    chamfer = 1e3 * part_values(figures_of(found, name, CHAMFER))
    right = [value for own in figures_of(found, name, TOPOLOGY).values() for value in own.values()]
    spread = "–"
    if len(chamfer):
        spread = f"{np.median(chamfer):.2f} ({chamfer.min():.2f}–{chamfer.max():.2f})"
    hold = f"{sum(right):.0f} of {len(right) + failed}"
    return [Cell(spread), Cell(f"{hold}, {failed} failed" if failed else hold)]


def view(name: str, found: list[Result], rows: list[Row]) -> str:
    """A section: by kind of part, and all tables of a benchmark."""
    shown = [kinds_table([one for one in found if one.good], rows, BASELINE), *tables(found, BASELINE)]
    return "\n".join(
        [f"## At equal {name}\n", *(markdown(table).replace("## ", "### ", 1) for table in shown)]
    )

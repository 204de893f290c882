"""Tables 1 and 2 of arXiv 2511.03147 in their own form, every row beside the published one."""

from collections.abc import Sequence
from dataclasses import dataclass

from weingarten.bench.contender import Contender
from weingarten.bench.lineup import NONE, OWN, POISSON, lineup
from weingarten.bench.metric import PUBLISHED_METRICS, Metric
from weingarten.bench.results import Result
from weingarten.bench.statistics import Summary
from weingarten.bench.table import Cell, Table, ceiling_rows, marked_cells
from weingarten.reproduce.published import PUBLISHED_ROWS
from weingarten.reproduce.thin_parts import thin_parts
from weingarten.settings import Settings

TABLE_1 = {name: name for name in ("constant", "linear", "quintic", "step", "step-next")}
TABLE_2 = {"constant": "constant", "decreasing": "linear", "increasing": "increasing"}
"""A row's name in the paper and the schedule's here. The paper does not say that its decreasing row is the
linear one, but its counterpart, increasing, is linear."""

CAPTION = (
    "Mean (standard deviation between parts), protocol published-1, beside the paper's. Its parts are others "
    "and its fits stop by the distance to the truth: compare rows with rows, not with the paper's. Of the "
    "rows here the best is bold, the second best underlined."
)


@dataclass(frozen=True)
class Entrants:
    """Who takes part, by schedule. scheduled: those of the paper. others: OWN, NONE, POISSON, if they do."""

    scheduled: dict[str, Contender]
    others: dict[str, Contender]

    @property
    def everyone(self) -> list[Contender]:
        """In order."""
        return [*self.scheduled.values(), *self.others.values()]

    @classmethod
    def of(cls, budget: Settings, weight: float, oracle: bool, poisson: bool) -> "Entrants":
        """Every schedule of both tables; the method as it comes, and without curvature; screened Poisson.

        budget: its method is the one that is scheduled; where that comes with one of the schedules, it is
        not fitted again. weight: the greatest one. poisson: whether that takes part.
        """
        names = list(dict.fromkeys([*TABLE_1.values(), *TABLE_2.values()]))
        scheduled = lineup([budget.method], names, budget, weight, oracle)
        known = [one.description() for one in scheduled]
        own, none = lineup([budget.method], [OWN, NONE], budget, oracle=oracle)
        others = {OWN: own} if own.description() not in known else {}
        others[NONE] = none
        if poisson:
            (others[POISSON],) = lineup([POISSON], [], budget)
        return cls(dict(zip(names, scheduled, strict=True)), others)


def paper_tables(found: Sequence[Result], entrants: Entrants) -> list[Table]:
    """Both tables, and who else took part."""
    good = [one for one in found if one.good]
    first = {row: entrants.scheduled[schedule].name for row, schedule in TABLE_1.items()}
    second = {row: entrants.scheduled[schedule].name for row, schedule in TABLE_2.items()}
    others = {one.name: one.name for one in entrants.others.values()}
    return [
        paper_table("Table 1. Schedules of the ODW weight", good, first, TABLE_1),
        paper_table("Table 2. Constant, decreasing and increasing weights", good, second, TABLE_2),
        paper_table("Beside them, on the same clouds", good, others, {}),
        *thin_parts(good, entrants.others[NONE].name, [one.name for one in entrants.everyone]),
    ]


def paper_table(
    title: str, found: Sequence[Result], rows: dict[str, str], published: dict[str, str]
) -> Table:
    """rows: contender by the row's name. published: the paper's schedule by the row's name."""
    own = marked_cells(found, list(rows.values()), PUBLISHED_METRICS, as_in_the_paper)
    made = []
    for row, name in rows.items():
        cells = [Cell(row)]
        for metric, cell in zip(PUBLISHED_METRICS, own[name], strict=True):
            cells += [paper_cell(published.get(row), metric), cell]
        cells += [paper_seconds(published.get(row)), own_seconds(found, name)]
        made.append((*cells, Cell(str(sum(one.contender == name for one in found)))))
    pairs = [(f"{metric.heading}, paper", "here") for metric in PUBLISHED_METRICS]
    columns = ("", *(text for pair in pairs for text in pair), "seconds, paper", "here", "fits")
    return Table(title, CAPTION, columns, (*made, *ceilings(found)))


def as_in_the_paper(own: Summary, metric: Metric) -> str:
    """mean (deviation), two digits each."""
    return f"{own.mean * metric.factor:.2f} ({(own.deviation or 0.0) * metric.factor:.2f})"


def paper_cell(schedule: str | None, metric: Metric) -> Cell:
    """The published mean (deviation); nothing where the paper has no such row."""
    if schedule is None:
        return Cell("")
    mean, deviation = getattr(PUBLISHED_ROWS[schedule], metric.key.split(".")[1])
    return Cell(f"{mean:.2f} ({deviation:.2f})", mean / metric.factor)


def paper_seconds(schedule: str | None) -> Cell:
    """Published."""
    if schedule is None:
        return Cell("")
    seconds = PUBLISHED_ROWS[schedule].seconds
    return Cell(f"{seconds:.0f}", seconds)


def own_seconds(found: Sequence[Result], name: str) -> Cell:
    """Mean over the fits, from points in memory to the mesh."""
    own = [one.seconds for one in found if one.contender == name and one.seconds is not None]
    return Cell(f"{sum(own) / len(own):.1f}", sum(own) / len(own)) if own else Cell("none")


def ceilings(found: Sequence[Result]) -> list[tuple[Cell, ...]]:
    """What perfect meshes of the parts would score."""
    rows = []
    for name, *cells, count in ceiling_rows(PUBLISHED_METRICS, found):
        spread = [cell for own in cells for cell in (Cell(""), own)]
        rows.append((name, *spread, Cell(""), Cell(""), count))
    return rows

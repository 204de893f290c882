"""How every figure is distributed over parts and seeds, a row a contender."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from weingarten.bench.metric import METRICS, Metric
from weingarten.bench.results import Result
from weingarten.report.plot import GRID, INK, MUTED, colour, dots, inline, logarithmic, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, ROW, REST = 4.4, 0.225, 0.52
"""Inches: of a plot, of one of its rows, of its labels."""
SPREAD = 0.46
"""Of a row's points, in rows."""
GOLDEN = 0.618034
LENGTH = "×10⁻³"
"""The unit that all lengths are shown in."""
LOGARITHMIC = 12.0
"""Lengths that differ by more than this factor are drawn on a logarithmic scale."""
CEILING = "ceiling"


@dataclass(frozen=True)
class Plot:
    """title: the figure's name. protocol: its protocol's. note: which end is good. svg: the drawing."""

    title: str
    protocol: str
    note: str
    svg: str


@dataclass(frozen=True)
class Row:
    """A contender's shown values, and what each point says of itself."""

    name: str
    paint: str
    values: list[float]
    titles: list[str]


def distributions(found: Sequence[Result], names: Sequence[str]) -> list[Plot]:
    """One for every metric of which a contender has values. names: of the contenders, in the page's order."""
    plots = []
    with look():
        for number, metric in enumerate(METRICS):
            rows = rows_of(metric, found, names)
            if any(row.values for row in rows if row.name != CEILING):
                plots.append(drawn(metric, rows, f"spread{number}"))
    return plots


def rows_of(metric: Metric, found: Sequence[Result], names: Sequence[str]) -> list[Row]:
    """The contenders', and the ceiling's where there is one."""
    rows = []
    for number, name in enumerate(names):
        own = [one for one in found if one.contender == name and one.number(metric.key) is not None]
        values = [one.number(metric.key) or 0.0 for one in own]
        titles = [
            f"{one.part}, seed {one.seed}: {metric.shown(value)}"
            for one, value in zip(own, values, strict=True)
        ]
        rows.append(Row(name, colour(number), [value * metric.factor for value in values], titles))
    key = metric.key.replace(".", ".ceiling_", 1)
    most = {one.part: value for one in found if (value := one.number(key)) is not None}
    if most:
        titles = [f"{part}: {metric.shown(value)}" for part, value in most.items()]
        rows.append(Row(CEILING, MUTED, [value * metric.factor for value in most.values()], titles))
    return rows


def is_yes_or_no(rows: Sequence[Row]) -> bool:
    """Whether all values are 0 or 100 %: a property that a mesh has or not."""
    return all(value in (0.0, 100.0) for row in rows for value in row.values)


def drawn(metric: Metric, rows: Sequence[Row], name: str) -> Plot:
    """The plot of one metric, within `look`."""
    figure = new_figure(WIDTH, REST + ROW * len(rows))
    axes = figure.add_subplot()
    shares = metric.unit == "%" and is_yes_or_no(rows)
    titles = bars(axes, rows) if shares else strips(axes, rows, metric.unit == LENGTH)
    axes.set_yticks(range(len(rows)), [row.name for row in rows])
    for label, row in zip(axes.get_yticklabels(), rows, strict=True):
        label.set_color(MUTED if row.name == CEILING else INK)
    axes.set_ylim(len(rows) - 0.45, -0.55)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.set_xlabel(f"{metric.label}, % of the fits" if shares else metric.heading)
    note = "higher is better" if metric.higher else "lower is better"
    if metric.aim is not None:
        note = f"best at {metric.aim:g}"
    said = f"{metric.heading}, protocol {metric.protocol}: distribution over parts and seeds by contender."
    return Plot(metric.label, metric.protocol, note, inline(figure, name, said, titles))


def strips(axes: "Axes", rows: Sequence[Row], lengths: bool) -> dict[str, list[str]]:
    """All values of every row, the middle half as a bar, the median as a line; titles of the points.

    lengths: whether they may be drawn on a logarithmic scale.
    """
    for k, row in enumerate(rows):
        if not row.values:
            axes.text(0.01, k, "none", color=MUTED, va="center", transform=axes.get_yaxis_transform())
            continue
        spread = SPREAD * ((np.arange(len(row.values)) * GOLDEN + 0.5) % 1.0 - 0.5)
        dots(axes, row.values, list(k + spread), row.paint, str(k))
        low, middle, high = np.percentile(row.values, [25, 50, 75])
        axes.plot([low, high], [k, k], color=row.paint, lw=9, alpha=0.28, solid_capstyle="butt", zorder=2)
        axes.plot([middle, middle], [k - 0.34, k + 0.34], color=row.paint, lw=1.8, zorder=4)
    values = np.array([value for row in rows for value in row.values])
    if lengths and values.min() > 0 and values.max() > LOGARITHMIC * values.min():
        logarithmic(axes.xaxis, float(values.min()) / 1.15, float(values.max()) * 1.15)
    return {str(k): row.titles for k, row in enumerate(rows) if row.values}


def bars(axes: "Axes", rows: Sequence[Row]) -> dict[str, list[str]]:
    """How many values of every row are 100 %; nothing has a title."""
    for k, row in enumerate(rows):
        yes, total = sum(value > 0 for value in row.values), len(row.values)
        share = 100.0 * yes / total if total else 0.0
        axes.barh(k, 100.0, height=0.5, color=GRID, alpha=0.6, zorder=1)
        axes.barh(k, share, height=0.5, color=row.paint, alpha=0.75, zorder=2)
        axes.text(101.5, k, f"{yes} of {total}", color=INK, va="center", fontsize="small")
    axes.set_xlim(0, 100)
    axes.grid(visible=False)
    return {}

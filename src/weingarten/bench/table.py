"""The tables of a benchmark, ready for print in any form."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from weingarten.bench.metric import EXACT_METRICS, EXCESS, METRICS, PUBLISHED_METRICS, Metric
from weingarten.bench.results import Result
from weingarten.bench.statistics import Difference, Summary, difference, figures_of, summary

CEILING = "ceiling"
BEST, SECOND = "best", "second"
PAIRED = (*PUBLISHED_METRICS, *EXACT_METRICS[:8])
"""Metrics whose differences are tabulated."""
GLANCE = (*PUBLISHED_METRICS, EXACT_METRICS[0], EXACT_METRICS[10])
"""Metrics of the first table."""


@dataclass(frozen=True)
class Cell:
    """value: to sort by, None for text alone. mark: BEST, SECOND or the empty string."""

    text: str
    value: float | None = None
    mark: str = ""


@dataclass(frozen=True)
class Table:
    """rows: as many cells as columns; the first one names the row."""

    title: str
    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]


def tables(found: Sequence[Result], baseline: str | None = None) -> list[Table]:
    """Everything there is to say of the results; `baseline`, by default the first by name, is compared with.

    Tables without a row are left out.
    """
    good = [one for one in found if one.good]
    names = list(dict.fromkeys(one.contender for one in good))
    against = baseline or (names[0] if names else "")
    made = [
        glance(good, names),
        means("Means, protocol published-1", (*PUBLISHED_METRICS, EXCESS), good, names, PUBLISHED_NOTE),
        means("Means, protocol exact-1", EXACT_METRICS, good, names, EXACT_NOTE),
        extremes(good, names),
        differences(good, names, against),
        costs(found, names),
        per_part(METRICS[1], good, names),
        per_part(EXACT_METRICS[0], good, names),
        troubles(found),
    ]
    return [table for table in made if table.rows]


def glance(found: Sequence[Result], names: Sequence[str]) -> Table:
    """The means that matter most, on one screen."""
    metrics = present(GLANCE, found)
    cells = marked_cells(found, names, metrics, lambda own, metric: metric.shown(own.mean))
    rows = []
    for name in names:
        seconds = mean_of([one.seconds for one in found if one.contender == name and one.seconds is not None])
        rows.append((Cell(name), *cells[name], Cell("none") if seconds is None else number(seconds)))
    heads = [f"{'exact ' if one in EXACT_METRICS else ''}{one.heading}{arrow(one)}" for one in metrics]
    caption = "Means over the parts; protocol published-1, and exact-1 where it says exact."
    return Table("At a glance", caption, ("", *heads, "seconds"), tuple(rows))


def present(metrics: Sequence[Metric], found: Sequence[Result]) -> list[Metric]:
    """Those that any result has."""
    return [metric for metric in metrics if any(metric.key in one.values for one in found)]


def marked_cells(
    found: Sequence[Result],
    names: Sequence[str],
    metrics: Sequence[Metric],
    text: Callable[[Summary, Metric], str],
) -> dict[str, list[Cell]]:
    """By contender, a cell for every metric: its mean, written by `text`, the best two contenders marked."""
    cells: dict[str, list[Cell]] = {name: [] for name in names}
    for metric in metrics:
        own = [summary(figures_of(found, name, metric.key), metric) for name in names]
        marks = marked([one and metric.loss(one.mean) for one in own])
        for name, one, mark in zip(names, own, marks, strict=True):
            cells[name].append(Cell("none") if one is None else Cell(text(one, metric), one.mean, mark))
    return cells


PUBLISHED_NOTE = (
    "Mean over the parts (standard deviation between parts; ± that between seeds of the mean). Each mesh is "
    "scaled by its own box and samples are compared with samples, as in the published tables; the ceiling is "
    "what the truth scores against another sample of itself. Best bold, second best underlined."
)
EXACT_NOTE = (
    "Mean over the parts (standard deviation between parts; ± that between seeds of the mean). Distances to "
    "triangles, in lengths of the truth's longest side. Best bold, second best underlined."
)


def means(
    title: str, metrics: Sequence[Metric], found: Sequence[Result], names: Sequence[str], caption: str
) -> Table:
    """A row a contender, a column a metric; and the ceiling, where one of the metrics has one."""
    metrics = present(metrics, found)
    cells = marked_cells(found, names, metrics, spread)
    rows = [(Cell(name), *cells[name], Cell(*counted(found, name))) for name in names]
    rows += ceiling_rows(metrics, found)
    return Table(title, caption, ("", *(m.heading + arrow(m) for m in metrics), "parts × seeds"), tuple(rows))


def arrow(metric: Metric) -> str:
    """Which end is good."""
    return "" if metric.aim is not None else " ↑" if metric.higher else " ↓"


def spread(own: Summary, metric: Metric) -> str:
    """mean (deviation) ± between seeds."""
    text = metric.shown(own.mean)
    if own.deviation is not None:
        text += f" ({metric.shown(own.deviation)})"
    if own.seeds is not None:
        text += f" ± {metric.shown(own.seeds)}"
    return text


def counted(found: Sequence[Result], name: str) -> tuple[str, float]:
    """How many fits a row stands for."""
    own = [one for one in found if one.contender == name]
    parts = len({one.part for one in own})
    seeds = len({one.seed for one in own})
    text = f"{parts} × {seeds}" if len(own) == parts * seeds else f"{len(own)} fits of {parts} parts"
    return text, float(len(own))


def ceiling_rows(metrics: Sequence[Metric], found: Sequence[Result]) -> list[tuple[Cell, ...]]:
    """What perfect meshes of these parts would score."""
    own = {one.part: one for one in found}.values()
    cells, parts = [Cell(CEILING)], 0
    for metric in metrics:
        protocol, name = metric.key.split(".", 1)
        values = {one.part: {0: one.number(f"{protocol}.ceiling_{name}")} for one in own}
        known = {part: {0: value[0]} for part, value in values.items() if value[0] is not None}
        parts = max(parts, len(known))
        one = summary(known, metric)
        cells.append(Cell("") if one is None else Cell(spread(one, metric), one.mean))
    return [(*cells, Cell(str(parts), float(parts)))] if parts else []


def marked(losses: Sequence[float | None]) -> list[str]:
    """Which is best and which second; ties share a mark, and one alone gets none."""
    ranked = sorted({loss for loss in losses if loss is not None})
    marks = dict(zip(ranked, (BEST, SECOND), strict=False)) if len(ranked) > 1 else {}
    return [marks.get(loss, "") if loss is not None else "" for loss in losses]


def extremes(found: Sequence[Result], names: Sequence[str]) -> Table:
    """Median and worst part of every metric."""
    metrics = present(METRICS, found)
    rows = []
    for name in names:
        cells = [Cell(name)]
        for metric in metrics:
            one = summary(figures_of(found, name, metric.key), metric)
            text = "none" if one is None else f"{metric.shown(one.median)} / {metric.shown(one.worst)}"
            cells.append(Cell(text, None if one is None else one.median))
        rows.append(tuple(cells))
    columns = ("", *(f"{metric.protocol}: {metric.heading}" for metric in metrics))
    return Table("Median / worst part", "Of the parts' means over the seeds.", columns, tuple(rows))


def differences(found: Sequence[Result], names: Sequence[str], baseline: str) -> Table:
    """Every contender against the baseline, part by part."""
    metrics = present(PAIRED, found)
    against = {metric: figures_of(found, baseline, metric.key) for metric in metrics}
    rows = []
    for name in names:
        if name != baseline:
            own = [
                difference(figures_of(found, name, metric.key), against[metric], metric) for metric in metrics
            ]
            cells = [difference_cell(one, metric) for one, metric in zip(own, metrics, strict=True)]
            rows.append((Cell(name), *cells))
    caption = (
        f"Contender minus {baseline}: mean of the parts' paired differences [95 % interval of that mean, by "
        "the bootstrap over parts], parts better : worse. An asterisk marks an interval that leaves out zero."
    )
    columns = ("", *(f"{metric.protocol}: {metric.heading}" for metric in metrics))
    return Table(f"Paired differences from {baseline}", caption, columns, tuple(rows))


def difference_cell(one: Difference | None, metric: Metric) -> Cell:
    """mean [low, high] better : worse."""
    if one is None:
        return Cell("none")
    mean, low, high = (
        f"{value * metric.factor:+.{metric.digits}f}" for value in (one.mean, one.low, one.high)
    )
    star = " *" if one.clear else ""
    return Cell(f"{mean} [{low}, {high}] {one.better} : {one.worse}{star}", one.mean)


def costs(found: Sequence[Result], names: Sequence[str]) -> Table:
    """Seconds of a fit, cloud to mesh."""
    rows = []
    for name in names:
        cells = [Cell(name)]
        for key in ("seconds", "cpu_seconds"):
            own = sorted(
                one.fit[key] for one in found if one.contender == name and one.good and key in one.fit
            )
            cells += [number(own[len(own) // 2]), number(own[-1])] if own else [Cell("none")] * 2
        failed = sum(one.contender == name and one.failed for one in found)
        rows.append((*cells, Cell(str(failed), float(failed))))
    caption = (
        "From points in memory to the mesh, wall clock and processor time of the process; whatever else the "
        "machine did is in the wall clock."
    )
    columns = ("", "seconds, median", "seconds, worst", "CPU seconds, median", "CPU seconds, worst", "failed")
    return Table("Cost of a fit", caption, columns, tuple(rows))


def number(value: float) -> Cell:
    """Seconds."""
    return Cell(f"{value:.1f}", value)


def per_part(metric: Metric, found: Sequence[Result], names: Sequence[str]) -> Table:
    """A row a part, a column a contender: means over the seeds."""
    figures = {name: figures_of(found, name, metric.key) for name in names}
    parts = sorted({part for own in figures.values() for part in own})
    rows = []
    for part in parts:
        values = [mean_of(list(figures[name].get(part, {}).values())) for name in names]
        marks = marked([None if value is None else metric.loss(value) for value in values])
        cells = [Cell(metric.shown(value), value, mark) for value, mark in zip(values, marks, strict=True)]
        rows.append((Cell(part), *cells, *ceiling_cell(metric, found, part)))
    last = (CEILING,) if metric in PUBLISHED_METRICS else ()
    title = f"{metric.heading} of every part, protocol {metric.protocol}"
    return Table(title, "Mean over the seeds.", ("", *names, *last), tuple(rows))


def ceiling_cell(metric: Metric, found: Sequence[Result], part: str) -> tuple[Cell, ...]:
    """What the truth itself scores, of a metric that has a ceiling."""
    if metric not in PUBLISHED_METRICS:
        return ()
    key = metric.key.replace(".", ".ceiling_", 1)
    value = next((one.number(key) for one in found if one.part == part), None)
    return (Cell(metric.shown(value), value),)


def mean_of(values: Sequence[float]) -> float | None:
    """None of nothing."""
    return sum(values) / len(values) if values else None


def troubles(found: Sequence[Result]) -> Table:
    """What failed, and what is odd, of a truth once for all its fits."""
    rows: dict[tuple[Cell, ...], None] = {}
    for one in found:
        part, fit = Cell(one.part), (Cell(one.contender), Cell(str(one.seed), float(one.seed)))
        if one.failed:
            rows[(part, *fit, Cell("failed: " + one.error))] = None
        for flag in one.flags:
            of_truth = flag.startswith("truth-")
            rows[(part, *((Cell("truth"), Cell("")) if of_truth else fit), Cell(flag))] = None
    caption = "Failed fits are in no mean. What a flag means is in docs/metrics.md."
    return Table("Failed and flagged", caption, ("", "contender", "seed", "what"), tuple(rows))

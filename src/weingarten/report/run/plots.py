"""The plots of a fit: how deviations are distributed, and how losses and weights went."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64, Int64

from weingarten.report.curves import WEIGHT, Columns, CurvePlot, Curves, binned, span, worded
from weingarten.report.plot import INK, MUTED, colour, inline, logarithmic, look, new_figure
from weingarten.report.run.colours import Colours
from weingarten.report.run.deviation import Deviation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BINS = 41
"""Of the histogram: an odd number, so that a bin has its middle at 0."""
SIZE = (4.9, 2.6)
TERM = (2.9, 2.1)
RATIOS = (1.5, 0.8)
"""Heights of loss and weight."""
MARKED = (50.0, 95.0, 99.0)
"""Shares of the points that the cumulative line marks."""
FINE = np.linspace(0.0, 100.0, 201)

Numbers = Float64[np.ndarray, " n"]


def counts(deviation: Deviation, colours: Colours) -> tuple[Int64[np.ndarray, " b"], Numbers, int]:
    """Points in every bin of the scale, the bins' edges, and how many points lie beyond both ends.

    A point on an edge counts in the bin above, and the last bin has both of its edges.
    """
    number, edges = np.histogram(deviation.value, BINS, (colours.start, colours.end))
    return number.astype(np.int64), edges, len(deviation.value) - int(number.sum())


def histogram(deviation: Deviation, colours: Colours) -> str:
    """Share of the points by their deviation, bars in the colours of the pictures."""
    number, edges, _ = counts(deviation, colours)
    edges = edges / colours.factor
    middle = (edges[1:] + edges[:-1]) / 2
    paints = colours.colours(middle * colours.factor)
    with look():
        figure = new_figure(*SIZE)
        axes = figure.add_subplot()
        share = 100.0 * number / len(deviation.value)
        axes.bar(middle, share, np.diff(edges), color=paints, edgecolor=MUTED, linewidth=0.35, zorder=2)
        axes.axvline(deviation.mean / colours.factor, color=INK, lw=1.0, dashes=(4, 3), zorder=3)
        axes.set_xlim(edges[0], edges[-1])
        axes.set_xlabel(f"deviation, in {colours.unit}")
        axes.set_ylabel("% of the points")
        axes.grid(visible=False, axis="x")
        return inline(figure, "histogram", "Histogram of the deviations of the points from the mesh.")


def cumulative(deviation: Deviation, colours: Colours) -> str:
    """Share of the points within d of the mesh, for every d up to the end of the scale."""
    distance = np.percentile(deviation.distance, FINE) / colours.factor
    with look():
        figure = new_figure(*SIZE)
        axes = figure.add_subplot()
        axes.plot(distance, FINE, color=colour(0), lw=1.6, zorder=3)
        for share in MARKED:
            d = float(np.percentile(deviation.distance, share)) / colours.factor
            axes.plot([d], [share], "o", ms=4, color=colour(0), mew=0, zorder=4)
            axes.annotate(
                f"{share:g} % within {d:.3g}",
                (d, share),
                (6, -3),
                textcoords="offset points",
                va="top",
                fontsize="small",
            )
        axes.set_xlim(0.0, 1.3 * colours.end / colours.factor)
        axes.set_ylim(0.0, 104.0)
        axes.set_xlabel(f"distance d, in {colours.unit}")
        axes.set_ylabel("% of the points within d")
        return inline(figure, "cumulative", "Share of the points within a distance of the mesh.")


def loss_plots(losses: Columns, planned: int) -> list[CurvePlot]:
    """The loss, then every term with its weight, over the steps; none without a loss curve."""
    if not losses:
        return []
    curves = binned("fit", colour(0), [losses])
    known = [term for term in curves.terms if np.isfinite(curves.columns[term]).any()]
    with look():
        total = CurvePlot("loss", "the weighted sum that is minimised", drawn(curves, "loss", planned))
        return [total, *(CurvePlot(worded(term), "", drawn(curves, term, planned)) for term in known)]


def drawn(curves: Curves, key: str, planned: int) -> str:
    """A column above, and beneath it its weight where it has one, over the steps."""
    weight = curves.columns.get(WEIGHT + key)
    figure = new_figure(*TERM)
    rows = RATIOS if weight is not None else RATIOS[:1]
    upper, *lower = figure.subplots(len(rows), 1, sharex=True, height_ratios=rows, squeeze=False)[:, 0]
    line(upper, curves, key, planned, curves.paint)
    logarithmic(upper.yaxis, *span([curves.columns[key]]))
    upper.set_ylabel("mean" if weight is not None else "loss")
    for axes in lower:
        own: Numbers = curves.columns[WEIGHT + key][0]
        line(axes, curves, WEIGHT + key, planned, INK)
        most = float(np.nanmax(own, initial=0.0))
        axes.set_ylim(-0.08 * most if most else -0.1, 1.15 * most or 1.0)
        axes.set_ylabel("weight")
    figure.axes[-1].set_xlabel("step")
    upper.set_xlim(0, planned)
    figure.align_ylabels()
    return inline(figure, f"curve-{key}", f"{worded(key)} and its weight over the steps of the fit.")


def line(axes: "Axes", curves: Curves, key: str, planned: int, paint: str) -> None:
    """A column over the steps, past bins that have no step of their own."""
    known = np.isfinite(curves.columns[key][0])
    axes.plot(planned * curves.bins[known], curves.columns[key][0][known], color=paint, lw=1.3)


def shares(seconds: dict[str, float]) -> Sequence[tuple[str, float, float]]:
    """Phases, their seconds, and their share of the longest phase in per cent."""
    longest = max(seconds.values(), default=0.0)
    return [(name, value, 100.0 * value / longest if longest > 0 else 0.0) for name, value in seconds.items()]

"""How losses and weights went over a fit, from the loss.csv that it leaves behind.

t is the progress of a fit, 0 at its first step and 1 at its last. All fits of a contender are brought to the
same bins of t: in each, the mean of the logarithm of a loss, the mean of a weight.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from weingarten.bench.job import DONE
from weingarten.bench.results import Result
from weingarten.fit.curve import Columns, read_curve
from weingarten.report.plot import INK, colour, inline, logarithmic, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BINS = 100
WEIGHT = "weight_"
OTHER = ("step", "progress", "rate", "loss", "seconds")
WIDTH, HEIGHT, WEIGHT_HEIGHT = 2.75, 2.3, 0.85
WIDE = (4.4, 2.3)
THIN = 60
"""Most thin lines of a plot; all fits count for the median and the band."""

Values = Float64[np.ndarray, " _"]
Rows = Float64[np.ndarray, "_ _"]
"""A row a fit, a column a bin."""


@dataclass(frozen=True)
class Curves:
    """All curves of one contender. bins: their centres. columns: by name, a row a fit, NaN where unknown."""

    name: str
    paint: str
    bins: Values
    columns: dict[str, Rows]

    @property
    def terms(self) -> list[str]:
        """The terms of its loss."""
        return [name for name in self.columns if name not in OTHER and not name.startswith(WEIGHT)]

    def moves(self, term: str) -> bool:
        """Whether a term's weight changes over the fit."""
        weights = self.columns[WEIGHT + term]
        known = weights[np.isfinite(weights)]
        return len(known) > 0 and float(np.ptp(known)) > 1e-6 * float(np.abs(known).max())


@dataclass(frozen=True)
class CurvePlot:
    """title: a contender or a term. note: what is not drawn. svg: the drawing."""

    title: str
    note: str
    svg: str


def all_curves(found: Sequence[Result], names: Sequence[str]) -> list[Curves]:
    """Of every contender that left loss curves; only fits that were made count."""
    every = []
    for number, name in enumerate(names):
        own = [one for one in found if one.contender == name and one.fit.get("status") == DONE]
        read = [columns for one in own if (columns := read_curve(one.entry.curve_path))]
        if read:
            every.append(binned(name, colour(number), read))
    return every


def binned(name: str, paint: str, read: Sequence[Columns]) -> Curves:
    """The curves of a contender's fits, all in the same bins of t."""
    count = min(BINS, max(len(columns["progress"]) for columns in read))
    heads = list(dict.fromkeys(key for columns in read for key in columns if key not in ("step", "progress")))
    nothing = np.full(count, np.nan)
    made = {
        key: np.stack([mean_in_bins(columns, key, count) if key in columns else nothing for columns in read])
        for key in heads
    }
    return Curves(name, paint, (np.arange(count) + 0.5) / count, made)


def mean_in_bins(columns: Columns, key: str, count: int) -> Values:
    """Geometric mean of what is above zero, in every bin; arithmetic of weights. NaN of an empty bin."""
    plain = key.startswith(WEIGHT)
    values = columns[key]
    good = np.isfinite(values) & (plain | (values > 0))
    place = np.clip((columns["progress"][good] * count).astype(np.int64), 0, count - 1)
    taken = values[good] if plain else np.log(values[good])
    number = np.bincount(place, minlength=count)
    total = np.bincount(place, weights=taken, minlength=count)
    mean = np.divide(total, number, out=np.full(count, np.nan), where=number > 0)
    return mean if plain else np.exp(mean)


def middle(rows: Rows) -> tuple[Values, Values, Values]:
    """Lower quartile, median and upper quartile of every bin, NaN where no fit has a value."""
    low, median, high = (np.full(rows.shape[1], np.nan) for _ in range(3))
    known = np.isfinite(rows).any(axis=0)
    low[known], median[known], high[known] = np.nanpercentile(rows[:, known], [25, 50, 75], axis=0)
    return low, median, high


def loss_plots(every: Sequence[Curves]) -> list[CurvePlot]:
    """Loss and moving weights of every contender, on common axes."""
    limits = span([curves.columns["loss"] for curves in every])
    moving = list(dict.fromkeys(term for curves in every for term in curves.terms if curves.moves(term)))
    weights = [c.columns[WEIGHT + term] for c in every for term in moving if term in c.columns]
    most = max((float(np.nanmax(own)) for own in weights if np.isfinite(own).any()), default=0.0)
    with look():
        return [drawn(curves, moving, limits, most, f"curve{k}") for k, curves in enumerate(every)]


def span(rows: Sequence[Rows]) -> tuple[float, float]:
    """Limits of a logarithmic axis that shows all of them."""
    known = np.concatenate([np.zeros(0), *(own[np.isfinite(own)] for own in rows)])
    return (float(known.min()) / 1.3, float(known.max()) * 1.3) if len(known) else (0.1, 1.0)


def drawn(
    curves: Curves, moving: Sequence[str], limits: tuple[float, float], most: float, name: str
) -> CurvePlot:
    """Loss above; below, where there are such, the weights that move in any contender, at most `most`."""
    figure = new_figure(WIDTH, HEIGHT if moving else HEIGHT - WEIGHT_HEIGHT)
    ratios = [HEIGHT - WEIGHT_HEIGHT, WEIGHT_HEIGHT] if moving else [1.0]
    upper, *lower = figure.subplots(len(ratios), 1, sharex=True, height_ratios=ratios, squeeze=False)[:, 0]
    rows = curves.columns["loss"]
    for row in rows[:THIN]:
        upper.plot(curves.bins, row, color=curves.paint, lw=0.5, alpha=0.3)
    banded(upper, curves, "loss")
    logarithmic(upper.yaxis, *limits)
    upper.set_ylabel("loss")
    for axes in lower:
        own = [term for term in moving if WEIGHT + term in curves.columns]
        for term, dashes in zip(own, ("-", "--", ":", "-.") * len(own), strict=False):
            axes.plot(curves.bins, middle(curves.columns[WEIGHT + term])[1], dashes, color=INK, lw=1.2)
        axes.set_ylim(-0.08 * most, 1.12 * most)
        axes.set_ylabel("weight")
    figure.axes[-1].set_xlabel("t")
    upper.set_xlim(0, 1)
    figure.align_ylabels()
    said = f"{curves.name}: loss and weight over the fit, {len(rows)} fits."
    return CurvePlot(curves.name, weights_in_words(curves, moving), inline(figure, name, said))


def banded(axes: "Axes", curves: Curves, key: str) -> None:
    """The median over the fits, and the band of the middle half."""
    low, median, high = middle(curves.columns[key])
    axes.fill_between(curves.bins, low, high, color=curves.paint, alpha=0.25, lw=0)
    axes.plot(curves.bins, median, color=curves.paint, lw=1.5)


def weights_in_words(curves: Curves, moving: Sequence[str]) -> str:
    """Which weights are drawn, and the constant ones."""
    constant = [
        f"{worded(term)} {np.nanmedian(curves.columns[WEIGHT + term]):g}"
        for term in curves.terms
        if term not in moving and np.isfinite(curves.columns[WEIGHT + term]).any()
    ]
    shown = [f"weight of {', '.join(map(worded, moving))}"] if moving else []
    return "; ".join([*shown, *([f"constant: {', '.join(constant)}"] if constant else [])])


def worded(name: str) -> str:
    """A term's name as words: off-diagonal Weingarten."""
    words = name.replace("off_", "off-").replace("_", " ")
    return words.replace("weingarten", "Weingarten").replace("dirichlet", "Dirichlet")


def term_plots(every: Sequence[Curves]) -> list[CurvePlot]:
    """Every term of the losses, unweighted: the contenders' medians on one axis each."""
    terms = list(dict.fromkeys(term for curves in every for term in curves.terms))
    plots = []
    with look():
        for k, term in enumerate(terms):
            own = [c for c in every if term in c.columns and np.isfinite(c.columns[term]).any()]
            if not own:
                continue
            figure = new_figure(*WIDE)
            axes = figure.add_subplot()
            for curves in own:
                axes.plot(curves.bins, middle(curves.columns[term])[1], color=curves.paint, lw=1.3)
            logarithmic(axes.yaxis, *span([middle(c.columns[term])[1][None] for c in own]))
            axes.set_xlim(0, 1)
            axes.set_xlabel("t")
            said = f"{worded(term)}: median over the fits of each contender."
            plots.append(CurvePlot(worded(term), "", inline(figure, f"term{k}", said)))
    return plots

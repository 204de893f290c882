"""The look that all figures of the paper share: one width, one type size, colours that the colour-blind tell.

matplotlib is an extra; it is imported here and in the figures when a figure is made, not before, and never
through pyplot: neither a window system nor any global setting is touched.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from weingarten.report.extra import required
from weingarten.report.heat import colour_map

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 6.3
"""Of every figure, inches: the text of a page; type stays readable at three quarters of it."""

TYPE, SMALL = 8.0, 7.0
"""Sizes of type, points."""

INK, MUTED, PALE = "#262b33", "#5d6673", "#d7dce2"
BLACK, ORANGE, SKY, GREEN = "#000000", "#e69f00", "#56b4e9", "#009e73"
BLUE, VERMILION, PURPLE, GREY = "#0072b2", "#d55e00", "#cc79a7", "#b4bbc4"
"""Okabe and Ito's colours, which the common colour-blindnesses tell apart, and a grey."""

LOOK = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "mathtext.fontset": "dejavusans",
    "font.size": TYPE,
    "axes.titlesize": TYPE,
    "axes.labelsize": TYPE,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "legend.fontsize": SMALL,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": MUTED,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "ytick.minor.size": 1.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": PALE,
    "grid.linewidth": 0.4,
    "legend.frameon": False,
    "lines.solid_capstyle": "butt",
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.fonttype": "path",
    "svg.hashsalt": "weingarten",
}
"""matplotlib's settings while a figure is made or written; all others are its defaults, not the user's."""


@contextmanager
def look() -> Iterator[None]:
    """Within, matplotlib draws in this look; afterwards it is as it was. Raises MissingExtraError."""
    with required("matplotlib.style").context(LOOK, after_reset=True):
        yield


def new_figure(height: float) -> "Figure":
    """An empty figure of the common width and that height, inches; within `look`."""
    from matplotlib.figure import Figure

    return Figure(figsize=(WIDTH, height))


def placed(figure: "Figure", left: float, bottom: float, width: float, height: float) -> "Axes":
    """Axes at a place of their own, in inches from the figure's lower left corner.

    No layout engine: one that measures type gives other places the second time.
    """
    whole = figure.get_figheight()
    return figure.add_axes((left / WIDTH, bottom / whole, width / WIDTH, height / whole))


def plate(figure: "Figure", left: float, bottom: float, width: float, height: float) -> "Axes":
    """Axes without frame or ticks, for a picture; placed likewise."""
    axes = placed(figure, left, bottom, width, height)
    axes.set_axis_off()
    return axes


def colour_bar(figure: "Figure", bottom: float, ticks: list[tuple[float, str]]) -> "Axes":
    """The colours of `report.heat` from left to right, so many inches above the figure's lower edge.

    ticks: places from 0 to 1 and what they say. The label is for the caller to set.
    """
    axes = placed(figure, 0.28 * WIDTH, bottom, 0.44 * WIDTH, 0.075)
    axes.imshow(colour_map()[None], extent=(0, 1, 0, 1), aspect="auto")
    axes.spines[:].set_visible(False)
    axes.grid(visible=False)
    axes.set_yticks([])
    axes.set_xticks([place for place, _ in ticks], [text for _, text in ticks])
    axes.tick_params(length=2.0, pad=1.5)
    return axes

"""Plots as SVG that stands in the page itself: in its type, in its colours by day and by night.

matplotlib gets stand-in colours, which are exchanged for the page's CSS variables afterwards. The same figure
is the same text, whenever it is drawn.
"""

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from html import escape
from typing import TYPE_CHECKING

from weingarten.report.extra import required

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import XAxis, YAxis
    from matplotlib.figure import Figure

INK, MUTED, GRID = "#010101", "#020202", "#030303"
STAND_INS = {INK: "--ink", MUTED: "--muted", GRID: "--grid"}
COLOURS = 12
"""How many colours the page has for contenders; more of them begin anew."""
GROUP = "points-"
SMALL, TYPE = 7.0, 7.6
"""Sizes of type, points; the page shows a point half as large again."""

LOOK = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": TYPE,
    "axes.titlesize": TYPE,
    "axes.labelsize": SMALL,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "legend.fontsize": SMALL,
    "text.color": INK,
    "axes.labelcolor": MUTED,
    "axes.edgecolor": GRID,
    "xtick.color": GRID,
    "ytick.color": GRID,
    "xtick.labelcolor": MUTED,
    "ytick.labelcolor": MUTED,
    "axes.linewidth": 0.7,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "xtick.minor.width": 0.5,
    "ytick.minor.width": 0.5,
    "xtick.major.size": 3,
    "ytick.major.size": 3,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": "none",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "figure.facecolor": "none",
    "savefig.facecolor": "none",
    "svg.fonttype": "none",
    "svg.hashsalt": "weingarten",
}


def colour(index: int) -> str:
    """The stand-in for the page's colour of the contender of that number."""
    return f"#0404{index % COLOURS:02x}"


@contextmanager
def look() -> Iterator[None]:
    """Within, matplotlib draws in the page's look. Raises MissingExtraError."""
    required("matplotlib")
    with required("matplotlib.style").context(LOOK, after_reset=True):
        yield


def new_figure(width: float, height: float) -> "Figure":
    """Empty, with room made for labels; inches."""
    figure = required("matplotlib.figure").Figure(figsize=(width, height), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.02, h_pad=0.02)
    return figure


def dots(axes: "Axes", x: Sequence[float], y: Sequence[float], paint: str, group: str) -> None:
    """Points that `inline` can give titles, by the name of their group."""
    axes.plot(x, y, "o", ms=3.1, color=paint, alpha=0.5, mew=0, gid=GROUP + group, clip_on=False, zorder=3)


def logarithmic(axis: "XAxis | YAxis", low: float, high: float) -> None:
    """Make an axis logarithmic, between two limits, with plain numbers at its ticks."""
    ticker = required("matplotlib.ticker")
    getattr(axis.axes, f"set_{axis.axis_name}scale")("log")
    getattr(axis.axes, f"set_{axis.axis_name}lim")(low, high)
    axis.set_major_locator(
        ticker.LogLocator(subs=(1.0, 2.0, 5.0) if high < 100 * low else (1.0,), numticks=12)
    )
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(ticker.NullFormatter())


def inline(figure: "Figure", name: str, said: str, titles: dict[str, list[str]] | None = None) -> str:
    """The figure as an `<svg>` element that fills its container. name: unique in the page.

    said: what it shows, for those who hear it. titles: by group of `dots`, what each point says of itself.
    """
    required("matplotlib.backends.backend_svg").FigureCanvasSVG(figure)
    stream = io.StringIO()
    nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
    figure.savefig(stream, format="svg", metadata=nothing)
    text = stream.getvalue()
    text = text[text.index("<svg ") :]
    text = re.sub(r"<(metadata|style)\b.*?</\1>", "", text, flags=re.DOTALL)
    text = re.sub(r"\s+", " ", text).replace("> <", "><")
    for group, own in (titles or {}).items():
        text = _titled(text, GROUP + group, own)
    text = _own_names(text, name)
    text = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px", text)
    text = re.sub(r"font-family: [^;\"]*; ?", "", text)
    text = re.sub(r'( (?:d|x|y)="[^"]*")', lambda found: _shorter(found[0]), text)
    for stand_in, variable in (STAND_INS | {colour(k): f"--c{k}" for k in range(COLOURS)}).items():
        text = text.replace(stand_in, f"var({variable})")
    box = re.search(r'viewBox="[^"]*"', text)
    body = text[text.index(">") + 1 :]
    return f'<svg {box[0] if box else ""} role="img" aria-label="{escape(said)}">{body}'.strip()


def _titled(text: str, group: str, titles: list[str]) -> str:
    """Every point of a group with its title, and their common style once."""
    start = text.index(f'<g id="{group}">')
    stop = text.index('<g id="', start + 1) if '<g id="' in text[start + 1 :] else len(text)
    own = iter(titles)
    style = re.search(r'<use [^>]*style="([^"]*)"', text[start:stop])
    points = re.sub(
        r'<use ([^>]*?)( style="[^"]*")?/>',
        lambda found: f"<use {found[1]}><title>{escape(next(own, ''))}</title></use>",
        text[start:stop],
    )
    points = points.replace(f'<g id="{group}">', f'<g style="{style[1] if style else ""}">', 1)
    return text[:start] + points + text[stop:]


def _own_names(text: str, name: str) -> str:
    """Ids that nothing refers to are taken out, the others become the figure's own."""
    used = set(re.findall(r'url\(#([^)]+)\)|href="#([^"]+)"', text))
    kept = {one or other for one, other in used}
    text = re.sub(
        r' id="([^"]+)"', lambda found: f' id="{name}-{found[1]}"' if found[1] in kept else "", text
    )
    return re.sub(r'(url\(#|href="#)', rf"\1{name}-", text)


def _shorter(numbers: str) -> str:
    """Coordinates to a hundredth of a point."""
    return re.sub(r"-?\d+\.\d{3,}", lambda found: f"{float(found[0]):.2f}".rstrip("0").rstrip("."), numbers)

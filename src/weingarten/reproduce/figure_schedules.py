"""Figures 2 and 4 of arXiv 2511.03147: the weight of the ODW term over the progress of a fit.

Every line is what the Schedule of that name gives, on a linear scale and on one that shows the last
thousandth. Figure 2 has the decreasing schedules beside the constant one, the step in both readings (the
paper's formula takes the weight of the knot last passed, its released code that of the knot to come);
Figure 4 has constant, decreasing and increasing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from weingarten.errors import OptionError
from weingarten.reproduce import style
from weingarten.schedules.schedule import SCHEDULES, Schedule

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FIGURE_2 = ("constant", "linear", "quintic", "step", "step-next")
FIGURE_4 = ("constant", "linear", "increasing")

SAMPLES = 401
LEAST = 1e-4
"""Below this weight the right panel's scale is linear, down to zero."""

HEIGHT = 2.45
LEFTS, BOTTOM, BREADTH, TALL = (0.42, 3.55), 0.40, 2.68, 1.56
"""Of the two panels, inches."""


@dataclass(frozen=True)
class Line:
    """How a schedule is drawn. dashes: on, off, … in line widths; empty for a solid line."""

    label: str
    colour: str
    dashes: tuple[float, ...] = ()
    width: float = 1.5


LINES = {
    "constant": Line("constant", style.GREY, width=3.2),
    "linear": Line("linear", style.BLUE),
    "quintic": Line("quintic", style.VERMILION, (5.0, 1.2)),
    "step": Line("step: formula", style.BLACK, (1.1, 1.1)),
    "step-next": Line("step: released code", style.GREEN, (4.0, 1.2, 1.1, 1.2)),
    "increasing": Line("increasing", style.ORANGE, (5.0, 1.2)),
    "none": Line("none", style.PURPLE, (1.1, 1.1)),
}


def curve(schedule: Schedule, samples: int = SAMPLES) -> Float64[np.ndarray, "n 2"]:
    """(t, weight) along a schedule: evenly spaced, at every knot and just before it, so that jumps stand."""
    knots = np.array([time for time, _ in schedule.knots])
    times = np.unique(np.concatenate([np.linspace(0, 1, samples), knots, np.nextafter(knots, -1.0)]))
    times = times[times >= 0]
    return np.stack([times, [schedule(float(time)) for time in times]], axis=1)


def falls(name: str) -> bool:
    """Whether the schedule of that name ends below its beginning."""
    return SCHEDULES[name](1.0) < SCHEDULES[name](0.0)


def figure_schedules(names: Sequence[str] = FIGURE_2) -> "Figure":
    """The weights of these schedules over t, left on a linear scale, right on a logarithmic one.

    Raises OptionError for a name that is none of SCHEDULES; MissingExtraError without matplotlib.
    """
    unknown = [name for name in names if name not in SCHEDULES]
    if unknown:
        raise OptionError(f"There is no schedule {unknown[0]!r}; choose one of {', '.join(SCHEDULES)}.")
    with style.look():
        figure = style.new_figure(HEIGHT)
        plain, fine = (style.placed(figure, left, BOTTOM, BREADTH, TALL) for left in LEFTS)
        for axes in (plain, fine):
            _draw(axes, names)
        plain.set_ylim(-0.3, 10.6)
        plain.set_ylabel(r"weight $\lambda_{\mathrm{ODW}}(t)$")
        plain.set_title("linear scale", color=style.MUTED)
        _refine(fine)
        handles, labels = plain.get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper center", ncols=len(names), handlelength=2.6)
    return figure


def _draw(axes: "Axes", names: Sequence[str]) -> None:
    """All lines, and a tick at every knot."""
    for name in names:
        line = LINES.get(name, Line(name, style.INK))
        label = f"decreasing: {line.label}" if "increasing" in names and falls(name) else line.label
        times, weights = curve(SCHEDULES[name]).T
        (drawn,) = axes.plot(times, weights, color=line.colour, linewidth=line.width, label=label)
        drawn.set_linestyle((0, line.dashes) if line.dashes else "-")
        drawn.set_clip_on(False)
    knots = sorted({time for name in names for time, _ in SCHEDULES[name].knots} | {1.0})
    axes.set_xticks(knots, [f"{time:g}" for time in knots])
    axes.set_xlim(0.0, 1.0)
    axes.set_xlabel("progress $t$ (step / steps)")


def _refine(axes: "Axes") -> None:
    """The scale that shows small weights, and zero."""
    axes.set_yscale("symlog", linthresh=LEAST, linscale=0.6)
    decades = [10.0**power for power in range(round(np.log10(LEAST)), 2)]
    labels = [f"$10^{{{round(np.log10(weight))}}}$" for weight in decades]
    axes.set_yticks([0.0, *decades], ["0", *labels])
    axes.set_yticks([], minor=True)
    axes.set_ylim(-LEAST / 5, 30.0)
    axes.set_title(f"logarithmic scale, linear below {labels[0]}", color=style.MUTED)

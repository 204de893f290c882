"""The lines of Figures 2 and 4 are the schedules, knot by knot."""

import numpy as np
import pytest

from weingarten.errors import OptionError
from weingarten.reproduce.figure_schedules import FIGURE_2, FIGURE_4, curve, falls, figure_schedules
from weingarten.schedules.schedule import SCHEDULES

TABLE = {
    "linear": {0.2: 10, 0.21: 9.67, 0.25: 8.33, 0.3: 6.67, 0.35: 5.0, 0.4: 3.33, 0.5: 0.001, 0.8: 0.0004},
    "quintic": {0.2: 10, 0.21: 8.44, 0.25: 4.02, 0.3: 1.32, 0.35: 0.31, 0.4: 0.042, 0.5: 0.001, 0.8: 0.0},
    "step": {0.2: 10, 0.4999: 10, 0.5: 0.001, 0.8: 0.001, 1.0: 0.0},
    "step-next": {0.1999: 10, 0.2: 0.001, 0.4: 0.001, 0.5: 0.0},
    "constant": {0.0: 10, 0.5: 10, 1.0: 10},
    "increasing": {0.0: 0, 0.2: 0, 0.35: 4.9995, 0.5: 9.999, 1.0: 10},
}
"""Weights by time: method §4's table, and what its text says of the other schedules."""


@pytest.mark.parametrize("name", SCHEDULES)
def test_curves_are_the_schedules_values(name: str):
    schedule = SCHEDULES[name]
    line = curve(schedule)
    assert (np.diff(line[:, 0]) > 0).all()
    assert line[0, 0] == 0.0
    assert line[-1, 0] == 1.0
    assert line[:, 1].tolist() == [schedule(time) for time in line[:, 0].tolist()]
    for time, _ in schedule.knots:
        assert time in line[:, 0]


@pytest.mark.parametrize("name", TABLE)
def test_curves_pass_the_table_of_the_method(name: str):
    line = curve(SCHEDULES[name], samples=10_001)
    for time, weight in TABLE[name].items():
        nearest = line[np.abs(line[:, 0] - time).argmin()]
        if time in (0.2, 0.5):
            nearest = line[line[:, 0] == time][0]
        assert nearest[0] == pytest.approx(time, abs=1e-12)
        assert nearest[1] == pytest.approx(weight, abs=0.006 if weight > 0.1 else 6e-4)


def test_jumps_stand_upright():
    line = curve(SCHEDULES["step"], samples=3)
    at = np.flatnonzero(line[:, 0] == 0.5)[0]
    assert line[at - 1 : at + 1, 1].tolist() == [10.0, 0.001]
    assert line[at, 0] - line[at - 1, 0] < 1e-15


@pytest.mark.parametrize("names", [FIGURE_2, FIGURE_4])
def test_figures_draw_the_curves_on_both_scales(names: tuple[str, ...]):
    plain, fine = figure_schedules(names).axes
    for axes in (plain, fine):
        assert len(axes.lines) == len(names)
        for name, drawn in zip(names, axes.lines, strict=True):
            assert np.array_equal(np.stack(drawn.get_data(), axis=1), curve(SCHEDULES[name]))
    assert (plain.get_yscale(), fine.get_yscale()) == ("linear", "symlog")
    assert [tick.get_text() for tick in plain.get_xticklabels()] == ["0", "0.2", "0.5", "1"]


def test_lines_are_named_apart():
    for names in (FIGURE_2, FIGURE_4, tuple(SCHEDULES)):
        labels = [line.get_label() for line in figure_schedules(names).axes[0].lines]
        assert len(set(labels)) == len(names)
    assert falls("linear")
    assert not falls("constant")
    assert not falls("increasing")


def test_unknown_schedules_are_refused():
    with pytest.raises(OptionError, match="no schedule 'cosine'"):
        figure_schedules(("linear", "cosine"))

"""Deviations of points at known distances from a cube, their colours, and the bins of their histogram."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))
from one_run import MIDDLE, SIDE, box, cloud

from weingarten.mesh import Mesh
from weingarten.report.run import plots
from weingarten.report.run.colours import UNKNOWN, Colours, digits, worded
from weingarten.report.run.deviation import Deviation


@pytest.fixture(scope="module")
def deviation() -> Deviation:
    return Deviation.of(box(), cloud())


def test_figures_are_those_of_the_known_distances(deviation: Deviation):
    assert deviation.signed
    assert deviation.mean == pytest.approx((600 * 0.1 - 300 * 0.15 + 5 * 0.5) / 1000)
    square = (600 * 0.1**2 + 300 * 0.15**2 + 5 * 0.5**2) / 1000
    assert deviation.spread == pytest.approx(np.sqrt(square - deviation.mean**2))
    assert deviation.worst == pytest.approx(0.5)
    within = dict(deviation.within)
    assert within[50.0] == pytest.approx(0.1)
    assert within[90.0] == within[95.0] == within[99.0] == pytest.approx(0.15)
    assert within[99.9] == pytest.approx(0.5)


def test_an_open_mesh_gives_no_sign(deviation: Deviation):
    whole = box()
    lid = Mesh(whole.vertices, whole.faces[:-1])
    assert not Deviation.of(lid, cloud()).signed
    assert Deviation.of(lid, cloud()).value.min() >= 0


def test_a_mesh_turned_inside_out_has_the_same_inside(deviation: Deviation):
    turned = Deviation.of(Mesh(box().vertices, box().faces[:, ::-1]), cloud())
    assert turned.value == pytest.approx(deviation.value, abs=1e-12)


def test_bins_hold_the_known_groups(deviation: Deviation):
    colours = Colours.of(deviation.value, True, SIDE)
    assert colours.end == 0.2
    number, edges, beyond = plots.counts(deviation, colours)
    assert len(number) == plots.BINS
    assert beyond == 5
    expected = np.zeros(plots.BINS)
    for count, value in ((600, 0.1), (300, -0.15), (95, 0.0)):
        expected[np.searchsorted(edges, value, side="right") - 1] += count
    assert number.tolist() == expected.tolist()
    assert number[plots.BINS // 2] == 95
    assert (edges[0], edges[-1]) == (-0.2, 0.2)


def test_places_have_the_deviation_of_the_nearest_point(deviation: Deviation):
    """Every point's own foot gives back its deviation; a place that no point is near gives none."""
    own = deviation.at(deviation.foot)
    assert own == pytest.approx(deviation.value, abs=1e-12)
    top = cloud()[cloud()[:, 2] > MIDDLE[2] + 0.4 * SIDE]
    half = Deviation.of(box(), top)
    bottom = MIDDLE - [0, 0, SIDE / 2]
    assert np.isnan(half.at(bottom[None])).all()
    assert np.isfinite(half.at(MIDDLE[None] + [0, 0, SIDE / 2])).all()


@pytest.mark.parametrize(("signed", "levels"), [(True, [1, 1, 128, 255, 0]), (False, [1, 1, 1, 255, 0])])
def test_levels_go_from_end_to_end_and_zero_is_unknown(signed: bool, levels: list[float]):
    colours = Colours(2.0, signed)
    value = np.array([-9.0, -2.0, 0.0, 2.0, np.nan])
    assert colours.levels(value).tolist() == levels
    assert colours.colours(value)[-1] * 255 == pytest.approx([0x5D, 0x57, 0x68])
    assert UNKNOWN == "#5d5768"


def test_ticks_have_signs_and_a_unit():
    assert [text for _, text in Colours(0.2, True).ticks()] == ["≤ −0.2", "−0.1", "0", "+0.1", "≥ +0.2"]
    small = Colours(2e-5, False)
    assert [text for _, text in small.ticks()] == ["0", "5", "10", "15", "≥ 20"]
    assert small.unit == "10⁻⁶ of the cloud’s unit"


def test_numbers_have_no_exponent_that_need_none():
    assert digits(59180.4, 4) == "59,180"
    assert (digits(1000.0, 4), digits(1234.56, 5), digits(0.9999, 3)) == ("1,000", "1,234.6", "1")
    assert digits(0.00012345, 3) == "0.000123"
    assert digits(2.5e12, 4) == "2.5e+12"
    assert digits(0.0, 4) == "0"
    assert (worded(-0.25, True), worded(0.25, True), worded(0.25, False)) == ("−0.25", "+0.25", "0.25")

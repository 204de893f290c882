"""The weights of method §4, to the digit; and every knot that no schedule should accept."""

import doctest

import pytest
from hypothesis import given
from hypothesis import strategies as st

from weingarten.errors import OptionError
from weingarten.schedules import schedule as module
from weingarten.schedules.schedule import (
    DECREASING,
    SCHEDULES,
    SHAPES,
    Schedule,
    constant,
    parse_knots,
)

TABLE = {
    "linear": {0.2: 10, 0.21: 9.67, 0.25: 8.33, 0.3: 6.67, 0.35: 5.00, 0.4: 3.33, 0.5: 0.001, 0.8: 0.0004},
    "quintic": {0.2: 10, 0.21: 8.44, 0.25: 4.02, 0.3: 1.32, 0.35: 0.31, 0.4: 0.042, 0.5: 0.001, 0.8: 0.0},
    "step": {0.0: 10, 0.1: 10, 0.2: 10, 0.3: 10, 0.49999: 10, 0.5: 0.001, 0.8: 0.001, 0.99999: 0.001, 1.0: 0},
    "step-next": {
        0.0: 10,
        0.1: 10,
        0.19999: 10,
        0.2: 0.001,
        0.3: 0.001,
        0.49999: 0.001,
        0.5: 0,
        0.8: 0,
        1.0: 0,
    },
    "increasing": {0.0: 0, 0.1: 0, 0.2: 0, 0.35: 4.9995, 0.5: 9.999, 0.75: 9.9995, 1.0: 10},
    "constant": {0.0: 10, 0.5: 10, 1.0: 10},
}
DIGITS = {0.31: 0.005, 0.042: 0.0005, 0.001: 1e-12, 0.0004: 1e-12}

times = st.floats(0, 1)
weights = st.floats(0, 1e6)
knot_lists = st.lists(times, min_size=1, max_size=8, unique=True).flatmap(
    lambda ts: st.tuples(*[st.tuples(st.just(t), weights) for t in sorted(ts)])
)


@pytest.mark.parametrize(
    ("name", "t", "weight"), [(n, t, w) for n, row in TABLE.items() for t, w in row.items()]
)
def test_the_table_of_the_method(name, t, weight):
    accuracy = (
        1e-12 if name not in ("linear", "quintic") else 1.1e-5 if weight == 0 else DIGITS.get(weight, 0.005)
    )
    assert SCHEDULES[name](t) == pytest.approx(weight, rel=0, abs=accuracy)


@pytest.mark.parametrize("t", [0.2, 0.27, 0.3, 0.41, 0.499])
def test_formulas_within_the_falling_segment(t):
    r = (t - 0.2) / 0.3
    assert SCHEDULES["linear"](t) == pytest.approx(10 + (0.001 - 10) * r, rel=1e-12)
    assert SCHEDULES["quintic"](t) == pytest.approx(10 + (0.001 - 10) * (1 - (1 - r) ** 5), rel=1e-12)


def test_the_two_readings_of_step_differ_by_one_knot():
    formula, released = SCHEDULES["step"], SCHEDULES["step-next"]
    assert [formula(t) for t in (0.0, 0.2, 0.5, 1.0)] == [10.0, 10.0, 0.001, 0.0]
    assert [released(t) for t in (0.0, 0.2, 0.5, 1.0)] == [10.0, 0.001, 0.0, 0.0]


@given(knots=knot_lists, shape=st.sampled_from(sorted(SHAPES)), t=times)
def test_pure_and_within_the_knots_weights(knots, shape, t):
    schedule = Schedule(shape, knots)
    weight = schedule(t)
    assert weight == schedule(t) == Schedule(shape, knots)(t)
    low, high = min(w for _, w in knots), max(w for _, w in knots)
    assert low * (1 - 1e-9) - 1e-300 <= weight <= high * (1 + 1e-9)


@given(knots=knot_lists, t=times)
def test_order_of_calls_does_not_matter(knots, t):
    schedule = Schedule("quintic", knots)
    forth = [schedule(x) for x in (0.0, t, 1.0)]
    assert [schedule(x) for x in (1.0, t, 0.0)] == forth[::-1]


@given(knots=knot_lists, shape=st.sampled_from(["linear", "quintic", "step"]))
def test_at_a_knot_its_own_weight_holds(knots, shape):
    for time, weight in knots:
        assert Schedule(shape, knots)(time) == weight


@given(knots=knot_lists, shape=st.sampled_from(sorted(SHAPES)))
def test_the_ends_hold_beyond_the_knots(knots, shape):
    schedule = Schedule(shape, knots)
    assert schedule(-1.0) == knots[0][1]
    assert schedule(knots[-1][0]) == schedule(2.0) == knots[-1][1]


@pytest.mark.parametrize(
    "knots",
    [
        (),
        ((0.5, 1.0), (0.2, 1.0)),
        ((0.2, 1.0), (0.2, 2.0)),
        ((-0.1, 1.0),),
        ((0.0, 1.0), (1.1, 1.0)),
        ((0.0, -1.0),),
        ((0.0, float("inf")),),
        ((0.0, float("nan")),),
        ((float("nan"), 1.0),),
        ((0.0, 1.0), (float("nan"), 1.0)),
        ((float("inf"), 1.0),),
    ],
)
@pytest.mark.parametrize("shape", sorted(SHAPES))
def test_bad_knots(knots, shape):
    with pytest.raises(OptionError) as caught:
        Schedule(shape, knots)
    assert str(caught.value).endswith(".")


def test_unknown_names_list_what_there_is():
    with pytest.raises(OptionError, match="linear, quintic, step, step-next"):
        Schedule("cubic", DECREASING)


@pytest.mark.parametrize(
    "text", ["", ",", "0", "0:", ":1", "0:1,", "0:1;1:2", "a:b", "0:1:2", "0:10 1:0", "0=1", "0:1,,1:0"]
)
def test_knots_that_cannot_be_parsed(text):
    with pytest.raises(OptionError, match="0:10,1:0"):
        parse_knots(text)


def test_knots_are_parsed():
    assert parse_knots("0:10,0.2:10,0.5:0.001,1:0") == DECREASING
    assert parse_knots(" 0 : 0 , 1e-1 : 2 ") == ((0.0, 0.0), (0.1, 2.0))


@given(knots=knot_lists)
def test_parsing_reverses_writing(knots):
    assert parse_knots(",".join(f"{time!r}:{weight!r}" for time, weight in knots)) == knots


def test_scaling_keeps_the_shape():
    scaled = SCHEDULES["quintic"].peaking(3.0)
    assert scaled.greatest == pytest.approx(3.0)
    for t in (0.0, 0.3, 0.7, 1.0):
        assert scaled(t) == pytest.approx(0.3 * SCHEDULES["quintic"](t), rel=1e-12)


def test_no_weight_stays_none_however_it_is_scaled():
    assert SCHEDULES["none"].peaking(3.0)(0.5) == 0.0
    assert constant(3.0)(0.7) == 3.0


def test_the_examples_in_the_docstrings():
    failed, tried = doctest.testmod(module)
    assert (failed, tried) == (0, 2)

"""Means, spreads and differences against plain formulas, and whether the interval is honest."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import spearmanr

from weingarten.bench.metric import EXACT_METRICS, METRICS, Metric
from weingarten.bench.results import Result
from weingarten.bench.statistics import correlation, difference, figures_of, interval, summary
from weingarten.bench.store import Entry

CD = METRICS[1]
NC = METRICS[0]
VOLUME = next(metric for metric in EXACT_METRICS if metric.aim is not None)


def result(part: str, contender: str, seed: int, value: float | None, key: str = CD.key) -> Result:
    return Result(part, contender, seed, "", {key: value}, (), Entry(Path("nowhere")), {})


def test_a_part_counts_once_however_often_it_was_fitted():
    figures = {"a": {0: 1.0, 1: 3.0}, "b": {0: 5.0}}
    made = summary(figures, CD)
    assert made is not None
    assert (made.mean, made.median, made.worst, made.parts) == (3.5, 3.5, 5.0, 2)
    assert made.deviation == pytest.approx(np.std([2.0, 5.0], ddof=1))


def test_spread_between_seeds_is_that_of_the_mean_over_parts_with_all_seeds():
    figures = {"a": {0: 1.0, 1: 2.0}, "b": {0: 3.0, 1: 6.0}, "c": {0: 100.0}}
    made = summary(figures, CD)
    assert made is not None
    assert made.seeds == pytest.approx(np.std([2.0, 4.0], ddof=1))


@pytest.mark.parametrize(("metric", "worst"), [(CD, 3.0), (NC, 0.5), (VOLUME, 3.0)])
def test_worst_is_the_end_that_the_metric_calls_bad(metric: Metric, worst: float):
    made = summary({"a": {0: 0.5}, "b": {0: 3.0}, "c": {0: 1.0}}, metric)
    assert made is not None
    assert made.worst == worst


def test_a_single_part_has_no_deviation_and_none_has_no_summary():
    made = summary({"a": {0: 1.0}}, CD)
    assert made is not None
    assert made.deviation is None
    assert made.seeds is None
    assert summary({}, CD) is None


def test_figures_leave_out_what_does_not_exist():
    found = [result("a", "x", 0, 1.0), result("a", "x", 1, None), result("b", "y", 0, 2.0)]
    assert figures_of(found, "x", CD.key) == {"a": {0: 1.0}}


def test_truth_values_count_as_shares():
    found = [
        result("a", "x", 0, True, "exact-1.watertight"),
        result("b", "x", 0, False, "exact-1.watertight"),
    ]
    assert figures_of(found, "x", "exact-1.watertight") == {"a": {0: 1.0}, "b": {0: 0.0}}


def test_a_difference_is_taken_on_common_parts_and_seeds_alone():
    mine = {"a": {0: 1.0, 1: 9.0}, "b": {0: 2.0}, "c": {0: 7.0}}
    its = {"a": {0: 2.0}, "b": {0: 2.5, 1: 0.0}, "d": {0: 1.0}}
    made = difference(mine, its, CD)
    assert made is not None
    assert made.mean == pytest.approx((-1.0 - 0.5) / 2)
    assert (made.better, made.worse, made.parts) == (2, 0, 2)
    assert difference({"a": {0: 1.0}}, {"a": {1: 1.0}}, CD) is None


VALUES = st.lists(st.floats(-10, 10), min_size=2, max_size=12)


@given(VALUES, VALUES)
def test_a_difference_changes_sign_with_its_sides(mine: list[float], its: list[float]):
    one = {str(part): {0: value} for part, value in enumerate(mine)}
    two = {str(part): {0: value} for part, value in enumerate(its)}
    forth, back = difference(one, two, NC), difference(two, one, NC)
    assert forth is not None
    assert back is not None
    assert forth.mean == pytest.approx(-back.mean, abs=1e-12)
    assert (forth.better, forth.worse) == (back.worse, back.better)
    assert forth.low == pytest.approx(-back.high, abs=1e-9)
    assert forth.low <= forth.mean + 1e-9
    assert forth.mean <= forth.high + 1e-9


def test_the_interval_of_equal_differences_is_a_point_and_clear():
    made = difference({str(k): {0: k + 0.5} for k in range(9)}, {str(k): {0: float(k)} for k in range(9)}, CD)
    assert made is not None
    assert (made.low, made.high) == (0.5, 0.5)
    assert made.clear


def test_the_interval_holds_the_true_mean_about_as_often_as_it_says():
    draw = np.random.default_rng(0)
    held = 0
    for _ in range(300):
        low, high = interval(draw.normal(1.0, 2.0, 25))
        held += low <= 1.0 <= high
    assert 0.89 <= held / 300 <= 0.98


@given(
    st.lists(st.integers(-5, 5), min_size=4, max_size=9), st.lists(st.integers(-5, 5), min_size=9, max_size=9)
)
def test_rank_correlation_is_scipys_and_its_interval_holds_it_or_nearly(first: list[int], second: list[int]):
    x, y = np.array(first, dtype=float), np.array(second[: len(first)], dtype=float)
    made = correlation(x, y)
    if np.ptp(x) == 0 or np.ptp(y) == 0:
        assert made is None
        return
    assert made is not None
    assert made.value == pytest.approx(spearmanr(x, y).statistic)
    assert -1 - 1e-9 <= made.low <= made.high <= 1 + 1e-9


def test_rank_correlation_of_what_always_grows_together_is_one():
    made = correlation(np.arange(9.0), np.arange(9.0) ** 3)
    assert made is not None
    assert made.value == pytest.approx(1.0)
    assert made.low == pytest.approx(1.0)
    assert correlation(np.arange(3.0), np.arange(3.0)) is None

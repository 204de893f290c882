"""A large cloud is thinned to a fair, repeatable choice of its points; any other is left alone."""

import numpy as np
import pytest

from weingarten.scan import thinning
from weingarten.scan.thinning import thinned, thinning_notes


@pytest.fixture(autouse=True)
def few(monkeypatch):
    monkeypatch.setattr(thinning, "MOST_POINTS", 1000)


def numbered(count: int) -> np.ndarray:
    """Points that tell their row."""
    return np.arange(3.0 * count).reshape(count, 3)


def rows(points: np.ndarray) -> np.ndarray:
    """Where points of a `numbered` cloud were."""
    np.testing.assert_array_equal(np.diff(points, axis=1), 1.0)
    return (points[:, 0] / 3).astype(int)


@pytest.mark.parametrize("count", [100, 999, 1000])
def test_a_cloud_that_is_not_large_is_the_same_object(count):
    points = numbered(count)
    assert thinned(points, 0) is points


@pytest.mark.parametrize("count", [1001, 1500, 7000, 60_000])
def test_a_choice_without_repeats_in_the_given_order(count):
    chosen = rows(thinned(numbered(count), 0))
    assert len(chosen) == 1000
    assert (np.diff(chosen) > 0).all()
    assert chosen[-1] < count


@pytest.mark.parametrize("count", [1500, 60_000])
def test_cloud_and_seed_alone_decide(count):
    first, again, other = (thinned(numbered(count), seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize("count", [1500, 60_000])
def test_every_point_is_as_likely_as_any_other(count):
    """Counts of 200 choices in 50 runs of rows: their variance is that of draws without replacement."""
    counts = np.zeros(50)
    for seed in range(200):
        counts += np.bincount(rows(thinned(numbered(count), seed)) * 50 // count, minlength=50)
    share = 1000 / count
    expected = 200 * 1000 / 50
    squares = ((counts - expected) ** 2).sum() / (expected * (1 - share))
    assert 25 < squares < 85


def test_the_user_is_told_where_points_are_left_out():
    assert thinning_notes(1000, 1000) == ()
    (note,) = thinning_notes(7000, 1000)
    assert "1,000 of the 7,000 points" in note

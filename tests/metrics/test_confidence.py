"""Confidence is one where a surface was scanned and falls to zero beside it."""

import numpy as np
import pytest

from weingarten.metrics.confidence import EIGHTH, confidence

RNG = np.random.default_rng(0)
PLATE = np.column_stack([RNG.uniform(-1, 1, (20_000, 2)), np.zeros(20_000)])


def by_hand(place, points, noise):
    """The formula, one place at a time, by every distance there is."""
    way = np.linalg.norm(points - place, axis=1)
    nearest = points[way.argmin()]
    apart = np.sort(np.linalg.norm(points - nearest, axis=1))[EIGHTH]
    return min(1.0, max(0.0, 2.0 - (way.min() - 4.0 * noise) / apart))


@pytest.mark.parametrize("noise", [0.0, 0.003])
def test_it_is_the_formula(noise):
    places = RNG.uniform(-1.1, 1.1, (50, 3)) * np.array([1.0, 1.0, 0.05])
    found = confidence(places, PLATE, noise)
    np.testing.assert_allclose(found, [by_hand(place, PLATE, noise) for place in places], atol=1e-12)
    assert 0.0 < found.mean() < 1.0


def test_what_was_scanned_is_certain_and_a_hole_is_not():
    kept = PLATE[np.linalg.norm(PLATE[:, :2], axis=1) > 0.3]
    places = np.column_stack([RNG.uniform(-0.95, 0.95, (5_000, 2)), np.zeros(5_000)])
    from_middle = np.linalg.norm(places[:, :2], axis=1)
    found = confidence(places, kept, 0.0)
    assert (found[from_middle > 0.33] > 0.5).all()
    assert found[from_middle > 0.33].mean() > 0.99
    assert (found[from_middle < 0.2] == 0.0).all()


def test_points_that_coincide_leave_it_defined():
    points = np.zeros((20, 3))
    np.testing.assert_array_equal(confidence(np.array([[0.0, 0, 0], [1.0, 0, 0]]), points, 0.0), [1.0, 0.0])

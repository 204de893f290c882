"""The noise of a cloud from the cloud alone."""

import math

import numpy as np
import pytest
from scipy.spatial import KDTree

from weingarten.samples.parts import sample_part
from weingarten.scan.noise import noise_level


def level(points):
    return noise_level(points, KDTree(points))


@pytest.mark.parametrize("sigma", [0.001, 0.01])
def test_gaussian_noise_of_a_plane(sigma):
    draw = np.random.default_rng(0)
    points = np.column_stack([draw.uniform(-1, 1, (20_000, 2)), draw.normal(0, sigma, 20_000)])
    # a quarter of the neighbourhoods has less than its share
    assert level(points) == pytest.approx(sigma * math.sqrt(2 / math.pi), rel=0.2)


def test_of_a_clean_part_it_is_next_to_nothing_and_rises_with_noise():
    points = sample_part("flange", 20_000, 0)
    size = float(np.ptp(points, axis=0).max())
    clean = level(points)
    assert clean < 1e-4 * size
    noisy = points + np.random.default_rng(0).normal(0, 0.002 * size, points.shape)
    assert level(noisy) == pytest.approx(0.002 * size * math.sqrt(2 / math.pi), rel=0.35)
    assert level(points * 1000) == pytest.approx(1000 * clean, rel=1e-9, abs=1e-9 * size)


def test_few_points_and_points_in_a_line():
    line = np.linspace(0, 1, 5)[:, None] * [1.0, 2.0, 3.0]
    assert level(line) < 1e-12

"""The noise of a cloud from the cloud alone."""

import math

import numpy as np
import pytest
from scipy.spatial import KDTree

from weingarten.samples.parts import sample_part
from weingarten.scan.noise import Noise, noise_level, noise_of


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


def noise(points):
    return noise_of(points, KDTree(points))


def scattered(name, deviation, count=30_000):
    """A bundled part with Gaussian noise of so many diagonals, and that as a length."""
    points = sample_part(name, count, 0)
    sigma = deviation * float(np.linalg.norm(np.ptp(points, axis=0)))
    return points + np.random.default_rng(1).normal(0, sigma, points.shape), sigma


@pytest.mark.parametrize("name", ["flange", "bracket", "block"])
@pytest.mark.parametrize("deviation", [0.001, 0.0025, 0.005])
def test_noise_is_told_and_measured(name, deviation):
    points, sigma = scattered(name, deviation)
    assert noise(points).level == pytest.approx(sigma, rel=0.15)


@pytest.mark.parametrize("name", ["flange", "bracket", "block"])
@pytest.mark.parametrize("count", [1000, 3000, 30_000])
def test_a_clean_part_has_none_however_few_its_points(name, count):
    assert noise(sample_part(name, count, 0)).level < 1e-4 * np.ptp(sample_part(name, count, 0), axis=0).max()


def curved(name, count):
    """A ball, or a tube of a ring, of random points."""
    random = np.random.default_rng(0)
    drawn = random.normal(size=(count, 3))
    if name == "ball":
        return drawn / np.linalg.norm(drawn, axis=1)[:, None]
    turn, round_ = random.uniform(0.0, 2.0 * np.pi, (2, count))
    radius = 0.7 + 0.3 * np.cos(round_)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 0.3 * np.sin(round_)])


@pytest.mark.parametrize("name", ["ball", "ring"])
@pytest.mark.parametrize("count", [1500, 5000, 30_000])
def test_curvature_is_no_noise(name, count):
    assert noise(curved(name, count)).level == 0.0


@pytest.mark.parametrize("sigma", [0.002, 0.005])
def test_noise_of_a_curved_surface_is_told(sigma):
    points = curved("ball", 30_000)
    points += sigma * np.random.default_rng(1).normal(size=points.shape)
    assert noise(points).level == pytest.approx(sigma, rel=0.15)


def test_more_noise_takes_larger_neighbourhoods():
    counts = [noise(scattered("block", deviation)[0]).neighbours for deviation in (0.001, 0.005, 0.01)]
    assert counts == sorted(counts)
    assert counts[0] < counts[2]


def test_two_sides_of_a_thin_wall_are_no_noise():
    random = np.random.default_rng(0)
    points = random.uniform(-1, 1, (4000, 3))
    points[:, 2] = random.choice([-0.02, 0.02], 4000)
    assert noise(points).level == 0.0


@pytest.mark.parametrize("scale", [1e-5, 1e6])
def test_noise_has_the_unit_of_the_points(scale):
    points, sigma = scattered("block", 0.0025, 10_000)
    assert noise(scale * points).level == pytest.approx(scale * noise(points).level, rel=1e-6)
    assert noise(scale * points).neighbours == noise(points).neighbours
    assert sigma > 0


def test_too_few_points_to_tell():
    assert noise(sample_part("block", 150, 0)) == Noise()

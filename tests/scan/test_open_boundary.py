"""Rims of open sheets and of holes are found where they are, and closed parts have none."""

import numpy as np
import pytest

from weingarten.samples.parts import sample_part
from weingarten.scan.open_boundary import LEAST, MOST_POINTS, rims
from weingarten.scan.sampling import corrupt


def disc(count, radius=1.0, seed=0):
    """Uniform on a disc."""
    random = np.random.default_rng(seed)
    rho, turn = radius * np.sqrt(random.random(count)), 2 * np.pi * random.random(count)
    return np.stack([rho * np.cos(turn), rho * np.sin(turn), np.zeros(count)], axis=1)


def ball(count, seed=0):
    """Uniform on the unit sphere."""
    directions = np.random.default_rng(seed).standard_normal((count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


@pytest.mark.parametrize("count", [500, 5_000, 80_000])
def test_the_rim_of_a_disc(count):
    points = disc(count)
    found = points[np.concatenate(rims(points))]
    spacing = np.sqrt(np.pi / min(count, MOST_POINTS))
    assert (np.linalg.norm(found, axis=1) > 1.0 - 2.0 * spacing).all()
    sectors = np.unique(np.floor(np.arctan2(found[:, 1], found[:, 0]) / (np.pi / 4)))
    assert len(sectors) == 8


@pytest.mark.parametrize("name", ["flange", "bracket", "block"])
@pytest.mark.parametrize("count", [600, 3_000, 20_000])
def test_closed_parts_have_none(name, count):
    assert rims(sample_part(name, count, 0)) == ()


def test_noise_makes_none():
    points = sample_part("flange", 20_000, 0)
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    assert rims(corrupt(points, 0.002 * diagonal, 0.0, 1)) == ()


def test_a_hole_and_the_rim_of_half_a_ball():
    points = ball(20_000)
    points = points[points[:, 2] > 0.0]
    hole = np.arccos(points[:, 2]) < 0.3
    points = points[~hole]
    angles = [np.arccos(points[chain, 2]) for chain in rims(points)]
    assert all(((angle > 1.5) | (angle < 0.36)).all() for angle in angles)
    assert any((angle < 0.36).all() for angle in angles)
    assert any((angle > 1.5).all() for angle in angles)


def test_the_longest_comes_first():
    far = np.array([10.0, 0.0, 0.0])
    found = rims(np.concatenate([disc(400, 0.2) + far, disc(10_000)]))
    lengths = [len(chain) for chain in found]
    assert lengths == sorted(lengths, reverse=True)
    assert min(lengths) >= LEAST


@pytest.mark.parametrize("count", [1, 30])
def test_too_few_points_have_none(count):
    assert rims(disc(count)) == ()


def test_points_at_one_place_have_none():
    assert rims(np.zeros((50, 3))) == ()

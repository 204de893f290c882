"""What is said of clouds that cannot tell their part."""

import numpy as np
import pytest
import torch

from weingarten.samples.parts import sample_part
from weingarten.scan.doubts import doubts
from weingarten.scan.noise import Noise
from weingarten.scan.sampling import corrupt
from weingarten.settings import resolve
from weingarten.start import Start


def of(points):
    return Start.of(points, resolve(steps=1), torch.device("cpu")).doubts


def test_nothing_speaks_against_a_good_scan():
    assert doubts(Noise(), 0.95, (), 10.0) == ()
    assert of(sample_part("bracket", 20_000, 0)) == ()


def test_noise_is_told_in_the_unit_of_the_cloud():
    points = sample_part("bracket", 20_000, 0)
    sigma = 0.0025 * float(np.linalg.norm(np.ptp(points, axis=0)))
    (said,) = of(corrupt(points, sigma, 0.0, 1))
    told = float(said.split("about ")[1].split()[0])
    assert told == pytest.approx(sigma, rel=0.15)


@pytest.mark.parametrize("name", ["flange", "bracket", "block"])
def test_too_few_points_are_told(name):
    assert any("too few points" in said for said in of(sample_part(name, 600, 0)))


def test_a_hole_is_told_where_it_is():
    points = sample_part("bracket", 20_000, 0)
    middle = points[points[:, 0].argmax()]
    (said,) = of(points[np.linalg.norm(points - middle, axis=1) > 12.0])
    place = [float(number) for number in said.split("around (")[1].split(")")[0].split(", ")]
    assert np.linalg.norm(place - middle) < 15.0
    assert int(said.split(": ")[1].split()[0]) > 20

"""A stencil's distance follows its schedule."""

import pytest
import torch

from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.coarse_to_fine import CoarseToFine
from weingarten.calculus.finite_difference import FiniteDifference
from weingarten.calculus.jet import TANGENT, Progressive
from weingarten.errors import OptionError
from weingarten.fields.siren import Siren
from weingarten.schedules.schedule import Schedule

SHRINKING = Schedule("linear", ((0.0, 0.1), (1.0, 0.01)))


def test_the_jet_of_a_moment_is_that_of_its_distance():
    inner = Autodiff(Siren(16, 3, 5.0, torch.Generator().manual_seed(0)).double())
    points = 2 * torch.rand(20, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(0)) - 1
    angles = torch.zeros(20, dtype=torch.float64)
    calculus = CoarseToFine(lambda h: FiniteDifference(inner, h), SHRINKING)
    assert isinstance(calculus, Progressive)
    for t, h in ((0.0, 0.1), (0.5, 0.055), (1.0, 0.01)):
        expected = FiniteDifference(inner, h)(points, TANGENT, angles).uv
        torch.testing.assert_close(calculus.at(t)(points, TANGENT, angles).uv, expected)
    torch.testing.assert_close(calculus(points, TANGENT, angles).uv, expected)


def test_a_distance_of_zero_is_refused():
    with pytest.raises(OptionError, match="above zero"):
        CoarseToFine(Autodiff, Schedule("linear", ((0.0, 0.1), (1.0, 0.0))))

"""Gradients by central differences: of second order, and enough for any higher stencil."""

import pytest
import torch

from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.central_gradient import CentralGradient
from weingarten.calculus.finite_difference import FiniteDifference
from weingarten.calculus.jet import GRADIENT, HESSIAN, TANGENT, VALUE
from weingarten.fields.siren import Siren


def field():
    return Siren(16, 3, 5.0, torch.Generator().manual_seed(0)).double()


def draw(*shape):
    return 2 * torch.rand(*shape, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(0)) - 1


def test_values_are_the_inner_ones_and_gradients_of_second_order():
    inner, points = Autodiff(field()), draw(200)
    exact = inner(points, GRADIENT)
    errors = []
    for h in (0.02, 0.005):
        jet = CentralGradient(inner, h)(points, GRADIENT)
        torch.testing.assert_close(jet.value, exact.value)
        errors.append((jet.slope - exact.slope).abs().mean().item())
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.02)
    assert torch.equal(CentralGradient(inner, 0.1)(points, VALUE).value, inner(points, VALUE).value)


def test_the_axes_are_the_last_coordinate_whatever_is_before():
    class Linear(torch.nn.Module):
        def forward(self, points):
            return points @ points.new_tensor([1.0, 2.0, -3.0])

    jet = CentralGradient(Autodiff(Linear()), 0.1)(draw(5, 2), GRADIENT)
    torch.testing.assert_close(jet.slope, jet.slope.new_tensor([1.0, 2.0, -3.0]).expand(5, 2, 3))


@pytest.mark.parametrize("order", [TANGENT, HESSIAN])
def test_a_whole_jet_without_any_derivative(order):
    inner, points = Autodiff(field()), draw(50)
    with pytest.raises(ValueError, match="FiniteDifference"):
        CentralGradient(inner, 0.01)(points, order)
    angles = torch.zeros(50, dtype=torch.float64)
    found = FiniteDifference(CentralGradient(inner, 0.003), 0.003)(points, order, angles)
    expected = inner(points, order, angles)
    for one, other in zip(found.tensors, expected.tensors, strict=True):
        assert (one - other).abs().mean() < 2e-3 * other.abs().mean().clamp_min(1.0)

"""The outer function: its derivatives against autograd's, and what it is made to be."""

import pytest
import torch

from weingarten.fields.choice import sphere_siren
from weingarten.fields.sphered import Sphered, fibonacci


@pytest.fixture
def field(generator):
    return sphere_siren(32, 3, 30.0, generator).double()


def test_derivatives_are_autograds(field):
    g = torch.tensor([-2.0, -0.3, -1e-5, 1e-6, 0.02, 0.7, 3.0], dtype=torch.float64, requires_grad=True)
    outer = field.outer(g)
    (first,) = torch.autograd.grad(outer.value.sum(), g, create_graph=True)
    (second,) = torch.autograd.grad(first.sum(), g)
    torch.testing.assert_close(outer.first, first)
    torch.testing.assert_close(outer.second, second)


def test_it_is_smooth_where_the_inner_field_is_zero(field):
    g = torch.tensor([-1e-12, 0.0, 1e-12], dtype=torch.float64)
    outer = field.outer(g)
    assert outer.second[1] == 0.0
    assert outer.first.isfinite().all()
    assert outer.first.min() > 0.0
    torch.testing.assert_close(outer.value[0], outer.value[2])


def test_forward_is_the_outer_function_of_the_inner_field(field, generator):
    points = torch.rand(9, 3, dtype=torch.float64, generator=generator)
    torch.testing.assert_close(field(points), field.outer(field.inner(points)).value)


@pytest.mark.parametrize(("radius", "slope"), [(1.0, 1.0), (0.5, 1.0), (1.6 / 1.11, 0.111)])
def test_it_is_zero_and_as_steep_as_asked_at_the_radius(generator, radius, slope):
    inner = sphere_siren(32, 3, 30.0, generator).inner
    sphered, directions = Sphered(inner, radius, slope), fibonacci(512).float()
    near, at, far = (sphered(k * radius * directions).mean().item() for k in (0.9, 1.0, 1.1))
    assert at == pytest.approx(0.0, abs=1e-3)
    assert far - near == pytest.approx(0.2 * radius * slope, rel=1e-2)


def test_scale_and_offset_go_with_the_weights(field, generator):
    other = sphere_siren(32, 3, 30.0, torch.Generator().manual_seed(9)).double()
    other.load_state_dict(field.state_dict())
    points = torch.rand(9, 3, dtype=torch.float64, generator=generator)
    assert torch.equal(other(points), field(points))


def test_directions_are_spread_evenly():
    directions = fibonacci(400)
    torch.testing.assert_close(directions.norm(dim=1), torch.ones(400, dtype=torch.float64))
    assert directions.mean(0).abs().max() < 0.01
    third = torch.eye(3, dtype=torch.float64) / 3
    torch.testing.assert_close(directions.T @ directions / 400, third, atol=0.01, rtol=0.0)

"""Jets of a field with an outer function: against autograd's, and so the gradients of every array's mean."""

import pytest
import torch

from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.choice import exact
from weingarten.calculus.composed import Composed
from weingarten.calculus.jet import GRADIENT, HESSIAN, TANGENT, VALUE
from weingarten.fields.choice import quadratic_siren, sphere_siren


@pytest.fixture(params=[sphere_siren, quadratic_siren])
def field(request, generator):
    made = request.param(12, 3, 5.0, generator).double()
    with torch.no_grad():
        for weight in made.parameters():
            weight.add_(0.02 * torch.randn(weight.shape, dtype=torch.float64, generator=generator))
    return made


@pytest.fixture
def points(generator):
    return 2 * torch.rand(20, 3, dtype=torch.float64, generator=generator) - 1


@pytest.mark.parametrize("order", [VALUE, GRADIENT, TANGENT, HESSIAN])
def test_jets_and_their_weight_gradients_are_autograds(field, points, order, generator):
    angles = 6 * torch.rand(20, dtype=torch.float64, generator=generator)
    calculus = exact(field)
    assert isinstance(calculus, Composed)
    own, reference = calculus(points, order, angles), Autodiff(field)(points, order, angles)
    assert len(own.tensors) == len(reference.tensors)
    for a, b in zip(own.tensors, reference.tensors, strict=True):
        torch.testing.assert_close(a, b, rtol=1e-9, atol=1e-10)
    mixes = [torch.randn(t.shape, dtype=torch.float64, generator=generator) for t in own.tensors]
    gradients = []
    for jet in (own, reference):
        loss = sum((tensor * mix).sum() for tensor, mix in zip(jet.tensors, mixes, strict=True))
        weights = list(field.parameters())
        gradients.append(torch.autograd.grad(loss, weights, allow_unused=True))
    for a, b in zip(*gradients, strict=True):
        none = torch.zeros(())
        torch.testing.assert_close(none if a is None else a, none if b is None else b, rtol=1e-8, atol=1e-9)

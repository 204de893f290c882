"""Jets of an ensemble are those of its members; so are the gradients of their weights."""

import torch
from hypothesis import given
from hypothesis import strategies as st

from weingarten.calculus.analytic import Analytic
from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.choice import Differences, exact
from weingarten.calculus.jet import GRADIENT, TANGENT, VALUE
from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren

OUTPUTS = {VALUE: 1, GRADIENT: 2, TANGENT: 5}


def sirens(members, width, depth):
    return [Siren(width, depth, 15.0, torch.Generator().manual_seed(i)).double() for i in range(members)]


def draw(count, members, seed=0):
    generator = torch.Generator().manual_seed(seed)
    points = 2.2 * torch.rand(count, members, 3, dtype=torch.float64, generator=generator) - 1.1
    return points, 6.3 * torch.rand(count, members, dtype=torch.float64, generator=generator)


def outputs(jet, order):
    return (jet.value, jet.gradient, jet.uu, jet.uv, jet.vv)[: OUTPUTS[order]]


def loss(jet, order, used):
    """A nonlinear function of those outputs that `used` names."""
    named = [x for x, wanted in zip(outputs(jet, order), used, strict=True) if wanted]
    return torch.stack([x.square().sum() + x.sum() for x in named]).sum()


def gradients(field, total):
    return torch.autograd.grad(total, list(field.parameters()), allow_unused=True, materialize_grads=True)


@given(
    order=st.sampled_from([VALUE, GRADIENT, TANGENT]),
    used=st.tuples(*[st.booleans()] * 5),
    members=st.integers(1, 4),
    width=st.integers(1, 20),
    depth=st.integers(1, 4),
    count=st.integers(1, 30),
)
def test_an_ensemble_is_its_members_side_by_side(order, used, members, width, depth, count):
    used = (used[0] or not any(used[: OUTPUTS[order]]), *used[1:])[: OUTPUTS[order]]
    fields, (points, angles) = sirens(members, width, depth), draw(count, members)
    ensemble = Ensemble.of(fields)
    jet = Analytic(ensemble)(points, order, angles)
    found = gradients(ensemble, loss(jet, order, used))
    for i, field in enumerate(fields):
        own = Analytic(field)(points[:, i], order, angles[:, i])
        for one, other in zip(outputs(jet, order), outputs(own, order), strict=True):
            torch.testing.assert_close(one[:, i], other, rtol=1e-10, atol=1e-10)
        expected = gradients(field, loss(own, order, used))
        scale = max(float(gradient.abs().max()) for gradient in expected)
        for one, other in zip(found, expected, strict=True):
            # a gradient that is zero is what sums of numbers of size one leave of it
            torch.testing.assert_close(one[i], other, rtol=0, atol=1e-10 * scale + 1e-13)


def test_autograd_agrees():
    ensemble, (points, angles) = Ensemble.of(sirens(3, 16, 3)), draw(40, 3)
    found, expected = (
        calculus(points, TANGENT, angles) for calculus in (exact(ensemble), Autodiff(ensemble))
    )
    for one, other in zip(outputs(found, TANGENT), outputs(expected, TANGENT), strict=True):
        torch.testing.assert_close(one, other, rtol=1e-10, atol=1e-10)
    used = (True,) * 5
    pairs = zip(
        gradients(ensemble, loss(found, TANGENT, used)),
        gradients(ensemble, loss(expected, TANGENT, used)),
        strict=True,
    )
    for one, other in pairs:
        torch.testing.assert_close(one, other, rtol=0, atol=1e-10 * float(other.abs().max()))


def test_the_stencil_is_that_of_the_members():
    fields, (points, angles) = sirens(3, 16, 3), draw(20, 3)
    jet = Differences()(Ensemble.of(fields))(points, TANGENT, angles)
    for i, field in enumerate(fields):
        own = Differences()(field)(points[:, i], TANGENT, angles[:, i])
        for one, other in zip(outputs(jet, TANGENT), outputs(own, TANGENT), strict=True):
            torch.testing.assert_close(one[:, i], other, rtol=1e-9, atol=1e-8)


def test_an_ensemble_in_float32_is_near_to_that_in_float64():
    ensemble, (points, angles) = Ensemble.of(sirens(3, 64, 5)), draw(100, 3)
    fine = Analytic(ensemble)(points, TANGENT, angles)
    coarse = Analytic(ensemble.float())(points.float(), TANGENT, angles.float())
    for one, other in zip(outputs(coarse, TANGENT), outputs(fine, TANGENT), strict=True):
        assert (one - other).abs().max() < 1e-4 * other.abs().max()


def test_methods_differentiate_an_ensemble_analytically():
    assert isinstance(exact(Ensemble.of(sirens(2, 8, 2))), Analytic)

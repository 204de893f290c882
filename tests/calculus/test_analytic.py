"""The hand-written jets and their backward against autograd's double backward."""

import itertools

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.calculus.analytic import Analytic
from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.jet import GRADIENT, HESSIAN, TANGENT, TENSORS, VALUE
from weingarten.fields.siren import Siren

ORDERS = (VALUE, GRADIENT, TANGENT, HESSIAN)


def siren(width=32, depth=5, frequency=30.0, seed=0):
    return Siren(width, depth, frequency, torch.Generator().manual_seed(seed)).double()


def draw(count, seed=0):
    """Points of the box, and angles."""
    generator = torch.Generator().manual_seed(seed)
    points = 2.2 * torch.rand(count, 3, dtype=torch.float64, generator=generator) - 1.1
    return points, 6.3 * torch.rand(count, dtype=torch.float64, generator=generator)


def outputs(jet, order):
    return every(jet)[: TENSORS[order]]


def every(jet):
    return jet.value, jet.gradient, jet.uu, jet.uv, jet.vv, jet.un, jet.vn, jet.nn


def loss(jet, order, used, seed=0):
    """A nonlinear function of the outputs named by `used`, each point with a coefficient of its own."""
    generator = torch.Generator().manual_seed(seed)
    total = jet.value.new_zeros(())
    for wanted, output in zip(used, outputs(jet, order), strict=True):
        coefficients = torch.randn(output.shape, dtype=torch.float64, generator=generator).to(output.dtype)
        if wanted:
            scale = output.detach().abs().mean().clamp_min(1e-3)
            total = total + (coefficients * (output + 0.1 * output * output / scale)).sum()
    return total


def weight_gradients(field, total):
    found = torch.autograd.grad(total, list(field.parameters()), allow_unused=True, materialize_grads=True)
    return [gradient.clone() for gradient in found]


def assert_near(found, expected, accuracy):
    """Within `accuracy` of the largest entry of each array."""
    for one, other in zip(found, expected, strict=True):
        assert one.shape == other.shape
        assert (one - other).abs().max() <= accuracy * other.abs().max().clamp_min(1e-30)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("depth", [1, 2, 5])
@pytest.mark.parametrize("frequency", [3.0, 30.0])
def test_jets_are_those_of_autograd(order, depth, frequency):
    field, (points, angles) = siren(depth=depth, frequency=frequency), draw(200)
    found = outputs(Analytic(field)(points, order, angles), order)
    assert_near(found, outputs(Autodiff(field)(points, order, angles), order), 1e-10)


@pytest.mark.parametrize("order", ORDERS)
def test_what_was_not_asked_for_is_none_and_angles_default_to_zero(order):
    field, (points, _) = siren(), draw(7)
    jet = Analytic(field)(points, order)
    assert all(x is None for x in every(jet)[TENSORS[order] :])
    assert_near(outputs(jet, order), outputs(Autodiff(field)(points, order), order), 1e-10)


@given(
    order=st.sampled_from(ORDERS),
    used=st.tuples(*[st.booleans()] * 8),
    width=st.integers(1, 40),
    depth=st.integers(1, 5),
    count=st.integers(1, 60),
    seed=st.integers(0, 1000),
)
@settings(max_examples=60, deadline=None)
def test_weight_gradients_of_any_loss(order, used, width, depth, count, seed):
    used = (used[0] or not any(used[: TENSORS[order]]), *used[1:])[: TENSORS[order]]
    field, (points, angles) = siren(width, depth, 15.0, seed), draw(count, seed)
    found = weight_gradients(field, loss(Analytic(field)(points, order, angles), order, used))
    expected = weight_gradients(field, loss(Autodiff(field)(points, order, angles), order, used))
    scale = max(gradient.abs().max() for gradient in expected)
    for one, other in zip(found, expected, strict=True):
        assert (one - other).abs().max() <= 1e-9 * scale


@pytest.mark.parametrize("used", list(itertools.product([False, True], repeat=5))[1:])
def test_every_choice_of_cotangents(used):
    field, (points, angles) = siren(16, 3), draw(30)
    found = weight_gradients(field, loss(Analytic(field)(points, TANGENT, angles), TANGENT, used))
    expected = weight_gradients(field, loss(Autodiff(field)(points, TANGENT, angles), TANGENT, used))
    scale = max(gradient.abs().max() for gradient in expected)
    for one, other in zip(found, expected, strict=True):
        assert (one - other).abs().max() <= 1e-9 * scale


@pytest.mark.parametrize("used", range(2, 8))
def test_every_cotangent_of_the_hessian_alone(used):
    used = tuple(index == used for index in range(8))
    field, (points, angles) = siren(16, 3), draw(30)
    found = weight_gradients(field, loss(Analytic(field)(points, HESSIAN, angles), HESSIAN, used))
    expected = weight_gradients(field, loss(Autodiff(field)(points, HESSIAN, angles), HESSIAN, used))
    scale = max(gradient.abs().max() for gradient in expected)
    for one, other in zip(found, expected, strict=True):
        assert (one - other).abs().max() <= 1e-9 * scale


@pytest.mark.parametrize("order", ORDERS)
def test_float32_agrees_with_float64(order):
    field, (points, angles) = siren(256), draw(500)
    points, angles = points.float().double(), angles.float().double()
    single = Siren(256, 5)
    single.load_state_dict(field.state_dict())
    field.load_state_dict(single.state_dict())
    used = (True,) * TENSORS[order]
    fine, coarse = (
        Analytic(field)(points, order, angles),
        Analytic(single)(points.float(), order, angles.float()),
    )
    assert_near([x.double() for x in outputs(coarse, order)], outputs(fine, order), 3e-5)
    expected = weight_gradients(field, loss(fine, order, used))
    found = weight_gradients(single, loss(coarse, order, used))
    assert all(gradient.dtype == torch.float32 for gradient in found)
    assert_near([gradient.double() for gradient in found], expected, 3e-4)


def test_interleaved_forwards_and_backwards_keep_their_own_buffers():
    field = siren(16, 3)
    calculus, reference = Analytic(field), Autodiff(field)
    batches = [draw(40, seed) for seed in range(3)]
    expected = [weight_gradients(field, reference(*inputs(b)).uv.abs().sum()) for b in batches]
    losses = [calculus(*inputs(b)).uv.abs().sum() for b in batches[:2]]
    assert_near(weight_gradients(field, losses[0]), expected[0], 1e-9)
    losses.append(calculus(*inputs(batches[2])).uv.abs().sum())
    assert_near(weight_gradients(field, losses[2]), expected[2], 1e-9)
    assert_near(weight_gradients(field, losses[1]), expected[1], 1e-9)


def inputs(batch):
    return batch[0], TANGENT, batch[1]


def test_outputs_and_gradients_outlive_the_buffers():
    field, (points, angles) = siren(16, 3), draw(40)
    calculus = Analytic(field)
    jet = calculus(points, TANGENT, angles)
    kept = [x.detach() for x in outputs(jet, TANGENT)]
    before = [x.clone() for x in kept]
    jet.uv.abs().sum().backward()
    gradients = [weight.grad for weight in field.parameters()]
    copies = [gradient.clone() for gradient in gradients]
    for seed in range(3):
        other = calculus(*inputs(draw(40, seed)))
        weight_gradients(field, other.uv.square().sum() + other.value.sum())
    assert all(torch.equal(a, b) for a, b in zip(kept + gradients, before + copies, strict=True))


def test_repeated_use_repeats_to_the_bit_and_takes_no_new_memory():
    field, (points, angles) = siren(16, 3), draw(40)
    calculus = Analytic(field)
    first = weight_gradients(field, calculus(points, TANGENT, angles).uv.abs().sum())
    shelved = sum(len(shelf) for shelf in calculus.buffers.free.values())
    for _ in range(5):
        again = weight_gradients(field, calculus(points, TANGENT, angles).uv.abs().sum())
        assert all(torch.equal(a, b) for a, b in zip(first, again, strict=True))
    assert sum(len(shelf) for shelf in calculus.buffers.free.values()) == shelved


def test_a_second_backward_of_the_same_graph_raises():
    field, (points, angles) = siren(16, 3), draw(40)
    total = Analytic(field)(points, TANGENT, angles).uv.abs().sum()
    total.backward(retain_graph=True)
    with pytest.raises(RuntimeError, match="once"):
        total.backward()


def test_gradients_accumulate_over_pieces():
    field, (points, angles) = siren(16, 3), draw(50)
    calculus = Analytic(field)
    whole = weight_gradients(field, calculus(points, TANGENT, angles).uv.abs().sum())
    for piece, turn in zip(points.split(16), angles.split(16), strict=True):
        calculus(piece, TANGENT, turn).uv.abs().sum().backward()
    assert_near([weight.grad for weight in field.parameters()], whole, 1e-11)


def test_inference_leaves_no_graph_and_hands_its_buffers_back():
    field, (points, angles) = siren(16, 3), draw(40)
    calculus = Analytic(field)
    with torch.no_grad():
        jet = calculus(points, TANGENT, angles)
    assert not jet.value.requires_grad
    assert sum(len(shelf) for shelf in calculus.buffers.free.values()) > 0
    assert_near(outputs(jet, TANGENT), outputs(Autodiff(field)(points, TANGENT, angles), TANGENT), 1e-10)

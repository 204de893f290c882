"""Adam is torch's; Muon's updates are nearly orthogonal; what they remember survives a checkpoint."""

import pytest
import torch
from torch import nn

from weingarten.fit.adam import Adam
from weingarten.fit.clip import clip
from weingarten.fit.muon import Muon, polar
from weingarten.fit.optimisers import muon


def descended(optimiser, weights, steps, seed=0):
    generator = torch.Generator().manual_seed(seed)
    for _ in range(steps):
        for weight in weights:
            weight.grad = torch.randn(weight.shape, generator=generator, dtype=weight.dtype)
        optimiser.step(1e-2)


def test_adam_is_that_of_torch():
    ours = [torch.ones(5, 3, dtype=torch.float64), torch.ones(4, dtype=torch.float64)]
    theirs = [weight.clone().requires_grad_(True) for weight in ours]
    reference = torch.optim.Adam(theirs, lr=1e-2)
    adam = Adam(ours)
    for step in range(20):
        for one, other in zip(ours, theirs, strict=True):
            one.grad = torch.full_like(one, (-1.0) ** step * (step + 1))
            other.grad = one.grad.clone()
        adam.step(1e-2)
        reference.step()
    for one, other in zip(ours, theirs, strict=True):
        assert torch.allclose(one, other.detach(), rtol=1e-12, atol=0)


@pytest.mark.parametrize("shape", [(64, 64), (40, 64)])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_polar_keeps_singular_vectors_and_evens_singular_values(shape, scale):
    matrix = scale * torch.randn(shape, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    U, S, Vt = torch.linalg.svd(matrix, full_matrices=False)
    seen = U.T @ polar(matrix) @ Vt.T
    expected = S / matrix.norm()
    for _ in range(5):
        expected = 3.4445 * expected - 4.7750 * expected**3 + 2.0315 * expected**5
    assert torch.allclose(seen, torch.diag(expected), rtol=0, atol=1e-10)
    large = expected[1e-3 * matrix.norm() < S]
    assert ((large > 0.4) & (large < 1.22)).all()


def test_polar_of_zero_is_zero():
    assert not polar(torch.zeros(4, 4)).any()


def test_muon_moves_a_matrix_by_the_size_of_an_update_of_adam():
    weight = torch.zeros(64, 64)
    descended(Muon([weight]), [weight], 1)
    assert float(weight.square().mean().sqrt()) == pytest.approx(0.2 * 1e-2, rel=0.2)


def test_muon_is_nesterov_momentum_on_the_polar_factor():
    weight = torch.zeros(16, 16, dtype=torch.float64)
    muon, momentum = Muon([weight], momentum=0.9), torch.zeros(16, 16, dtype=torch.float64)
    expected, generator = torch.zeros(16, 16, dtype=torch.float64), torch.Generator().manual_seed(0)
    for _ in range(5):
        weight.grad = torch.randn(16, 16, generator=generator, dtype=torch.float64)
        momentum = 0.9 * momentum + weight.grad
        expected -= 0.2 * 4.0 * 1e-2 * polar(weight.grad + 0.9 * momentum)
        muon.step(1e-2)
    assert torch.allclose(weight, expected, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("build", [Adam, Muon])
def test_what_an_optimiser_remembers_is_restored(build):
    straight, resumed = [torch.ones(8, 8)], [torch.ones(8, 8)]
    optimiser = build(straight)
    descended(optimiser, straight, 3)
    kept = {name: value.clone() for name, value in optimiser.state().items()}
    resumed[0].copy_(straight[0])
    other = build(resumed)
    other.restore(kept)
    descended(optimiser, straight, 3, seed=1)
    descended(other, resumed, 3, seed=1)
    assert torch.equal(straight[0], resumed[0])


@pytest.mark.parametrize("build", [Adam, Muon])
def test_jobs_in_any_order_are_the_same_move(build):
    moved = []
    for backwards in (False, True):
        weights, generator = [torch.ones(32, 32) * i for i in range(1, 5)], torch.Generator().manual_seed(0)
        optimiser = build(weights)
        for _ in range(3):
            for weight in weights:
                weight.grad = torch.randn(weight.shape, generator=generator)
            jobs = optimiser.jobs(*optimiser.factors(1e-2))
            for job in reversed(jobs) if backwards else jobs:
                job()
        moved.append(weights)
    assert all(torch.equal(one, other) for one, other in zip(*moved, strict=True))


@pytest.mark.parametrize("shape", [(16, 16), (10, 16)])
def test_polar_of_a_batch_is_that_of_each_matrix(shape):
    generator = torch.Generator().manual_seed(0)
    matrices = torch.randn(3, *shape, generator=generator, dtype=torch.float64)
    matrices *= torch.tensor([1e-6, 1.0, 1e6], dtype=torch.float64).view(3, 1, 1)
    for one, matrix in zip(polar(matrices), matrices, strict=True):
        torch.testing.assert_close(one, polar(matrix), rtol=0, atol=1e-13)


def stack(count=3):
    """Weights of so many parts, one scale each, and the same alone."""
    generator = torch.Generator().manual_seed(0)
    whole = torch.randn(count, 8, 8, generator=generator, dtype=torch.float64)
    return whole, [own.clone() for own in whole]


@pytest.mark.parametrize("build", [Adam, Muon])
def test_a_stack_of_weights_moves_as_each_would_alone(build):
    whole, alone = stack()
    together, apart = build([whole]), [build([own]) for own in alone]
    generator = torch.Generator().manual_seed(1)
    for _ in range(4):
        whole.grad = torch.randn(whole.shape, generator=generator, dtype=torch.float64)
        whole.grad *= torch.tensor([1e-3, 1.0, 1e3], dtype=torch.float64).view(3, 1, 1)
        together.step(1e-2)
        for own, gradient, optimiser in zip(alone, whole.grad, apart, strict=True):
            own.grad = gradient.clone()
            optimiser.step(1e-2)
    torch.testing.assert_close(whole, torch.stack(alone), rtol=0, atol=1e-13)


@pytest.mark.parametrize("build", [Adam, Muon])
def test_a_part_that_explodes_moves_no_other(build):
    moved = []
    for last in (1.0, float("nan"), float("inf")):
        whole, _ = stack()
        optimiser = build([whole])
        whole.grad = torch.ones_like(whole)
        whole.grad[2] = last
        clip([whole.grad], 1.0, 1)
        optimiser.step(1e-2)
        moved.append(whole)
    for whole in moved[1:]:
        assert not whole[2].isfinite().any()
        assert torch.equal(whole[:2], moved[0][:2])


@pytest.mark.parametrize("build", [Adam, Muon])
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_factors_on_the_device_move_weights_as_numbers_do(build, dtype):
    moved = []
    for tensors in (False, True):
        weights = [torch.ones(33, 33, dtype=dtype), torch.ones(16, 5, dtype=dtype)]
        optimiser, generator = build(weights), torch.Generator().manual_seed(0)
        for _ in range(3):
            for weight in weights:
                weight.grad = torch.randn(weight.shape, generator=generator, dtype=dtype)
            factors = optimiser.factors(1e-2)
            optimiser.move(*(torch.tensor(factors, dtype=dtype).unbind() if tensors else factors))
        moved.append(weights)
    assert all(torch.equal(one, other) for one, other in zip(*moved, strict=True))


def test_clipping_is_that_of_torch_for_every_part():
    generator = torch.Generator().manual_seed(0)
    gradients = [torch.randn(3, *shape, generator=generator) for shape in ((5, 4), (5,))]
    scale = torch.tensor([1e-3, 1.0, 1e3])
    gradients = [own * scale.view(3, *[1] * (own.dim() - 1)) for own in gradients]
    expected = []
    for i in range(3):
        weights = [torch.zeros_like(own[i]).requires_grad_(True) for own in gradients]
        for weight, own in zip(weights, gradients, strict=True):
            weight.grad = own[i].clone()
        torch.nn.utils.clip_grad_norm_(weights, 2.0)
        expected.append([weight.grad for weight in weights])
    clip(gradients, 2.0, 1)
    for own, others in zip(gradients, zip(*expected, strict=True), strict=True):
        torch.testing.assert_close(own, torch.stack(others))


def test_clipping_one_field_may_be_of_a_single_number_or_of_nothing():
    gradient = torch.tensor(-4.0)
    clip([gradient], 1.0, 0)
    assert float(gradient) == pytest.approx(-1.0, rel=1e-5)
    clip([], 1.0, 0)


@pytest.mark.parametrize("hidden", [64, nn.Linear(8, 8), nn.ModuleList([nn.Linear(8, 8)])])
def test_a_module_of_ones_own_may_call_anything_hidden(hidden):
    module = nn.Sequential(nn.Linear(3, 8), nn.Linear(8, 1))
    module.hidden = hidden
    assert [type(optimiser) for optimiser in muon(module)] == [Adam]

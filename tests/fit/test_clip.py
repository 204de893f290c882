"""Gradients of bounded norm."""

import torch

from weingarten.fit.clip import clip


def test_as_torch_does_it(generator):
    gradients = [torch.randn(4, 5, generator=generator), torch.randn(7, generator=generator)]
    for most in (0.5, 100.0):
        parameters = [torch.nn.Parameter(torch.zeros_like(gradient)) for gradient in gradients]
        for parameter, gradient in zip(parameters, gradients, strict=True):
            parameter.grad = gradient.clone()
        torch.nn.utils.clip_grad_norm_(parameters, most)
        own = [gradient.clone() for gradient in gradients]
        clip(own, most, 0)
        for mine, parameter in zip(own, parameters, strict=True):
            torch.testing.assert_close(mine, parameter.grad)


def test_every_part_by_itself(generator):
    both = torch.randn(2, 4, 5, generator=generator) * torch.tensor([0.01, 30.0]).view(2, 1, 1)
    together = both.clone()
    clip([together], 1.0, 1)
    assert torch.equal(together[0], both[0])
    torch.testing.assert_close(together[1].norm(), torch.ones(()))


def test_a_gradient_too_great_to_square_does_not_become_none_at_all():
    great = torch.tensor([[1e25, 0.0], [1.0, 2.0]])
    clip([great], 1.0, 1)
    assert great[0].isnan().any()
    assert torch.isfinite(great[1]).all()

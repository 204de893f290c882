"""Sizes, initial ranges and determinism of the SIREN, and its forward pass written out."""

import math

import pytest
import torch

from weingarten.fields.siren import Siren


def test_the_papers_network_has_264_449_weights():
    field = Siren()
    assert sum(weight.numel() for weight in field.parameters()) == 264_449
    assert [tuple(weight.shape) for weight in field.weights] == [(256, 3), *[(256, 256)] * 4, (1, 256)]
    assert [tuple(weight.shape) for weight in field.square_matrices] == [(256, 256)] * 4


@pytest.mark.parametrize("frequency", [10.0, 30.0])
def test_initial_weights_fill_their_ranges(generator, frequency):
    field = Siren(256, 5, frequency, generator).requires_grad_(False)
    for i, (weight, bias) in enumerate(zip(field.weights, field.biases, strict=True)):
        fan_in = weight.shape[1]
        bound = 1 / 3 if i == 0 else math.sqrt(6 / fan_in) / frequency
        low = 0.97 if i < 5 else 0.95
        assert low * bound < weight.abs().max() <= bound
        assert weight.mean().abs() < 5 * bound / math.sqrt(3 * weight.numel())
        assert weight.std() == pytest.approx(bound / math.sqrt(3), rel=0.12)
        assert bias.abs().max() <= 1 / math.sqrt(fan_in)
        if i < 5:
            assert bias.abs().max() > 0.95 / math.sqrt(fan_in)


def test_activations_keep_their_spread_through_the_layers(generator):
    """Sitzmann et al. 2020, §3.2: every sine layer's output is arcsine distributed, of variance ½."""
    field, a = (
        Siren(generator=generator).requires_grad_(False),
        2 * torch.rand(1000, 3, generator=generator) - 1,
    )
    for weight, bias in zip(list(field.weights)[:-1], list(field.biases)[:-1], strict=True):
        a = torch.sin(30.0 * (a @ weight.t() + bias))
        assert a.var() == pytest.approx(0.5, abs=0.05)


def test_forward_is_the_formula(generator):
    field = Siren(7, 2, 12.0, generator).double()
    points = torch.rand(5, 3, dtype=torch.float64, generator=generator)
    (w0, w1, w2), (b0, b1, b2) = field.weights, field.biases
    first = torch.sin(12.0 * (points @ w0.T + b0))
    second = torch.sin(12.0 * (first @ w1.T + b1))
    torch.testing.assert_close(field(points), second @ w2[0] + b2[0])


def test_the_generator_alone_decides():
    fields = []
    for noise in (1, 2):
        torch.manual_seed(noise)
        fields.append(Siren(16, 3, generator=torch.Generator().manual_seed(5)))
    same = zip(fields[0].parameters(), fields[1].parameters(), strict=True)
    assert all(torch.equal(a, b) for a, b in same)
    other = Siren(16, 3, generator=torch.Generator().manual_seed(6))
    assert not torch.equal(other.weights[0], fields[0].weights[0])


@pytest.mark.parametrize(("width", "depth"), [(1, 1), (8, 1), (8, 4)])
def test_any_size_works(width, depth):
    field = Siren(width, depth)
    assert field(torch.zeros(0, 3)).shape == (0,)
    assert field(torch.zeros(4, 3)).shape == (4,)
    assert len(field.square_matrices) == depth - 1

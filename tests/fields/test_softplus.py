"""The softplus network's forward pass written out, its sizes and its first weights."""

import math

import pytest
import torch

from weingarten.fields.softplus import SHARPNESS, SoftplusNet


def sigma(z):
    return torch.log1p(torch.exp(SHARPNESS * z)) / SHARPNESS


def test_forward_is_the_formula_with_the_points_again_halfway(generator):
    field = SoftplusNet(7, 4, generator=generator).double()
    points = 0.3 * torch.rand(5, 3, dtype=torch.float64, generator=generator)
    a = points
    for layer in range(4):
        a = torch.cat([a, points], 1) / math.sqrt(2) if layer == 2 else a
        a = sigma(a @ field.weights[layer].T + field.biases[layer])
    expected = a @ field.weights[4][0] + field.biases[4]
    torch.testing.assert_close(field(points), expected)


def test_the_authors_network_has_their_sizes():
    shapes = [tuple(weight.shape) for weight in SoftplusNet().weights]
    assert shapes == [(512, 3), (512, 512), (512, 512), (509, 512), *[(512, 512)] * 4, (1, 512)]
    assert len(SoftplusNet().square_matrices) == 6


def test_first_weights_are_the_theorems(generator):
    field = SoftplusNet(512, 3, 0.7, generator).requires_grad_(False)
    for weight in list(field.weights)[:-1]:
        assert weight.std() == pytest.approx(math.sqrt(2 / len(weight)), rel=0.05)
    assert field.weights[-1].mean() == pytest.approx(math.sqrt(math.pi / 512), rel=1e-3)
    assert [bias.abs().max().item() for bias in field.biases] == pytest.approx([0, 0, 0, 0.7])


@pytest.mark.parametrize(("width", "depth"), [(1, 1), (8, 1), (8, 4)])
def test_any_size_works(width, depth):
    field = SoftplusNet(width, depth) if width > 3 else SoftplusNet(width, 1)
    assert field(torch.zeros(0, 3)).shape == (0,)
    assert field(torch.zeros(4, 3)).shape == (4,)

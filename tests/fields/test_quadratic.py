"""Quadratic layers against their formula unit by unit, and how they begin."""

import torch

from weingarten.fields.quadratic import QuadraticSiren
from weingarten.fields.siren import Siren


def slow(layer, x):
    """One unit of one point at a time."""
    out = torch.zeros(len(x), len(layer.a), dtype=x.dtype)
    for i, point in enumerate(x):
        for unit in range(len(layer.a)):
            first = torch.dot(layer.A[unit], point) + layer.a[unit]
            second = torch.dot(layer.B[unit], point) + layer.b[unit]
            out[i, unit] = first * second + torch.dot(layer.C[unit], point**2) + layer.c[unit]
    return out


def stirred(generator):
    """All of its weights far from where they begin."""
    field = QuadraticSiren(Siren(5, 2, 3.0, generator), generator).double().requires_grad_(False)
    for weight in field.parameters():
        weight.add_(0.3 * torch.randn(weight.shape, dtype=torch.float64, generator=generator))
    return field


def test_forward_is_the_formula(generator):
    field = stirred(generator)
    points = torch.rand(4, 3, dtype=torch.float64, generator=generator)
    first, second, head = field.layers
    expected = slow(head, torch.sin(3.0 * slow(second, torch.sin(3.0 * slow(first, points)))))
    torch.testing.assert_close(field(points), expected[:, 0])


def test_it_begins_as_the_siren_that_it_is_made_of(generator):
    siren = Siren(64, 4, 30.0, generator)
    field = QuadraticSiren(siren, generator)
    points = torch.rand(100, 3, generator=generator)
    torch.testing.assert_close(field(points), siren(points), atol=5e-3, rtol=0.0)
    assert not torch.equal(field(points), siren(points))


def test_it_has_three_times_the_weights(generator):
    siren = Siren(16, 3)
    field = QuadraticSiren(siren)
    assert sum(w.numel() for w in field.parameters()) == 3 * sum(w.numel() for w in siren.parameters())
    assert [tuple(matrix.shape) for matrix in field.square_matrices] == [(16, 16)] * 2

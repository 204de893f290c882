"""An ensemble is its members side by side: same values, and the members come back as they were."""

import pytest
import torch

from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren


def members(count=3, width=16, depth=3, frequency=30.0):
    return [Siren(width, depth, frequency, torch.Generator().manual_seed(seed)) for seed in range(count)]


@pytest.mark.parametrize("depth", [1, 2, 5])
@pytest.mark.parametrize("frequency", [10.0, 30.0])
def test_column_i_is_member_i(generator, depth, frequency):
    fields = [field.double() for field in members(3, 8, depth, frequency)]
    ensemble = Ensemble.of(fields)
    points = torch.rand(5, 3, 3, dtype=torch.float64, generator=generator)
    values = ensemble(points)
    assert values.shape == (5, 3)
    for i, field in enumerate(fields):
        torch.testing.assert_close(values[:, i], field(points[:, i]), rtol=0, atol=1e-12)


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_members_come_back_as_they_were(dtype):
    fields = [field.to(dtype) for field in members()]
    ensemble = Ensemble.of(fields)
    assert len(ensemble) == 3
    for i, field in enumerate(fields):
        back = ensemble.member(i)
        assert back.frequency == field.frequency
        assert list(back.state_dict()) == list(field.state_dict())
        for one, other in zip(back.parameters(), field.parameters(), strict=True):
            assert torch.equal(one, other)
            assert one.dtype == dtype
            assert one.requires_grad


def test_a_member_has_memory_of_its_own():
    fields = members()
    ensemble = Ensemble.of(fields)
    back = ensemble.member(1)
    with torch.no_grad():
        for weight in ensemble.parameters():
            weight.zero_()
    for one, other in zip(back.parameters(), fields[1].parameters(), strict=True):
        assert torch.equal(one, other)


def test_square_matrices_are_those_between_sine_layers():
    found = Ensemble.of(members(2, 8, 4)).square_matrices
    assert [tuple(weight.shape) for weight in found] == [(2, 8, 8)] * 3


@pytest.mark.parametrize("other", [members(1, width=8), members(1, depth=2), members(1, frequency=10.0)])
def test_members_of_unlike_size_are_refused(other):
    with pytest.raises(ValueError, match="all of one width"):
        Ensemble.of([*members(1), *other])
    with pytest.raises(ValueError, match="needs members"):
        Ensemble.of([])

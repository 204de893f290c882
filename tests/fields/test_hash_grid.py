"""The encoding against one corner after another, its continuity, and its derivatives."""

import itertools

import pytest
import torch

from weingarten.fields.hash_grid import REACH, HashGrid, rows


@pytest.fixture
def grid(generator):
    """Two levels with rows of their own, one that shares them; features far from zero."""
    field = HashGrid(3, 2, 2, 12, 7, 8, generator=generator).double().requires_grad_(False)
    for table in field.tables:
        table.copy_(torch.randn(table.shape, generator=generator))
    return field


def row(i, j, k, cells, count):
    if (cells + 1) ** 3 <= count:
        return i * (cells + 1) ** 2 + j * (cells + 1) + k
    return (i ^ (j * 2654435761) ^ (k * 805459861)) % count


def slow(table, cells, point):
    """Corner by corner, in plain numbers."""
    at = [(float(x) / REACH + 1) / 2 * cells for x in point]
    low = [min(int(x), cells - 1) for x in at]
    total = torch.zeros(table.shape[1], dtype=torch.float64)
    for corner in itertools.product((0, 1), repeat=3):
        share = 1.0
        for x, base, step in zip(at, low, corner, strict=True):
            share *= x - base if step else 1 - (x - base)
        index = row(*(base + step for base, step in zip(low, corner, strict=True)), cells, len(table))
        total += share * table[index]
    return total


def test_levels_grow_geometrically():
    assert HashGrid().resolutions == [8, 11, 17, 25, 37, 54, 80, 118, 174, 256]
    assert [len(table) for table in HashGrid().tables][-3:] == [2**16] * 3


def test_interpolation_is_corner_by_corner(grid, generator):
    points = REACH * (2 * torch.rand(40, 3, dtype=torch.float64, generator=generator) - 1)
    points = torch.cat([points, torch.full((1, 3), REACH), torch.full((1, 3), -REACH)])
    where = (points / REACH + 1) / 2
    for cells, table in zip(grid.resolutions, grid.tables, strict=True):
        expected = torch.stack([slow(table, cells, point) for point in points])
        torch.testing.assert_close(grid.interpolated(where * cells, cells, table), expected)


def test_own_rows_are_all_different_and_shared_ones_are_within_the_table():
    corners = torch.cartesian_prod(*[torch.arange(6)] * 3)
    own = rows(corners, 5, 216)
    assert sorted(own.tolist()) == list(range(216))
    shared = rows(corners, 5, 50)
    assert shared.min() >= 0
    assert len(shared.unique()) == 50
    assert shared.max() == 49


def test_it_is_continuous_from_cell_to_cell(grid):
    cells = grid.resolutions[-1]
    border = -REACH + 2 * REACH * 5 / cells
    points = torch.tensor([[border, 0.13, -0.4]], dtype=torch.float64)
    step = torch.tensor([[1e-9, 0.0, 0.0]], dtype=torch.float64)
    torch.testing.assert_close(grid(points - step), grid(points + step), atol=1e-6, rtol=0.0)


def test_points_outside_have_the_features_of_the_border(grid):
    grid.network.directions.zero_()
    outside = torch.tensor([[2.0, 0.1, 0.2]], dtype=torch.float64)
    border = torch.tensor([[REACH, 0.1, 0.2]], dtype=torch.float64)
    inside = torch.tensor([[0.9 * REACH, 0.1, 0.2]], dtype=torch.float64)
    assert torch.equal(grid(outside), grid(border))
    assert not torch.equal(grid(outside), grid(inside))


def test_gradients_by_points_and_tables(grid, generator):
    points = (2 * torch.rand(4, 3, dtype=torch.float64, generator=generator) - 1).requires_grad_()
    table = grid.tables[-1].detach().clone().requires_grad_()

    def field(points, table):
        encoded = grid.interpolated(((points / REACH) + 1) / 2 * 12, 12, table)
        return encoded.square().sum(-1)

    assert torch.autograd.gradcheck(field, (points, table))


def test_second_derivatives_along_the_axes_are_zero_within_a_cell(grid):
    """Why curvature has to be taken by finite differences over a cell at least."""
    point = torch.tensor([[0.31, 0.12, 0.44]], dtype=torch.float64)
    table = grid.tables[0]

    def feature(x):
        return grid.interpolated((x / REACH + 1) / 2 * 2, 2, table)[0, 0]

    hessian = torch.autograd.functional.hessian(feature, point).squeeze()
    torch.testing.assert_close(hessian.diagonal(), torch.zeros(3, dtype=torch.float64))
    assert hessian.abs().max() > 0.1

"""Half-way nodes against a slow reference that visits each of them."""

import itertools
import math

import pytest
import torch

from weingarten.surface.bounds import PARITIES, halfway, interleaved, least, of_cells

SIDE, BLOCKS, REACH = 4, 3, 0.3
LAST = SIDE - 1
NODES = list(itertools.product(range(2 * LAST), repeat=3))


@pytest.fixture
def bounds(generator):
    return torch.randn(2, BLOCKS, SIDE, SIDE, SIDE, generator=generator)


def nearest(node):
    """The corners nearest to a half-way node, and the distance to them in half edges."""
    corners = itertools.product(*({place // 2, (place + 1) // 2} for place in node))
    return list(corners), math.sqrt(sum(place % 2 for place in node))


def bound(bounds, node):
    corners, distance = nearest(node)
    return torch.stack([bounds[:, :, x, y, z] for x, y, z in corners]).amax(dim=0) - REACH * distance


def test_halfway(bounds):
    found = interleaved(halfway(bounds.view(2, -1), SIDE, REACH), SIDE)
    assert found.shape == (2, BLOCKS, 2 * LAST, 2 * LAST, 2 * LAST)
    for x, y, z in NODES:
        torch.testing.assert_close(found[:, :, x, y, z], bound(bounds, (x, y, z)))


def test_least(bounds):
    found = least(halfway(bounds.view(2, -1), SIDE, REACH), SIDE).view(bounds.shape)
    for x, y, z in itertools.product(range(LAST), repeat=3):
        nodes = itertools.product(*(range(2 * first, 2 * first + 3) for first in (x, y, z)))
        expected = torch.stack([bound(bounds, node) for node in nodes]).amin(dim=0)
        torch.testing.assert_close(found[:, :, x, y, z], expected)


def test_of_cells(generator):
    cells = torch.rand(BLOCKS, SIDE, SIDE, SIDE, generator=generator) < 0.15
    found = of_cells(cells.view(-1), SIDE)
    for x, y, z in NODES:
        # the block of cells begins one cell lower: an even node lies between two of them, an odd one in one
        ranges = [range(place // 2 + place % 2, place // 2 + 2) for place in (x, y, z)]
        expected = torch.stack([cells[:, a, b, c] for a, b, c in itertools.product(*ranges)]).any(dim=0)
        part = found[PARITIES.index((x % 2, y % 2, z % 2))].view(cells.shape)
        assert torch.equal(part[:, x // 2, y // 2, z // 2], expected)

"""What changes of sign lack, against a slow reference that visits every edge."""

import itertools

import pytest
import torch

from weingarten.crew import Crew
from weingarten.surface import flood
from weingarten.surface.bricks import UNKNOWN, Bricks

COUNTS = (13, 10, 18)
INNER = [range(1, count - 1) for count in COUNTS]


def noise(known):
    """Bricks of random values; a share of the nodes is known by values, another by bounds, the rest not."""
    generator = torch.Generator().manual_seed(0)
    bricks = Bricks(COUNTS, torch.device("cpu"))
    nodes = torch.cartesian_prod(*(torch.arange(1, count - 1, dtype=torch.int32) for count in COUNTS)).T
    nodes = nodes[:, torch.rand(nodes.shape[1], generator=generator) < known]
    bricks.cover(nodes)
    bricks.grow()
    values = torch.randn(nodes.shape[1], generator=generator)
    bricks.assign(bricks.find(nodes), values)
    loose = bricks.find(nodes[:, ::3])
    bricks.bounds[:, loose] -= 0.1 * bricks.bounds[:, loose].abs()
    return bricks


def reference(bricks):
    """The nodes without which the edges that change sign are not complete, by their indices."""
    wanted = set()

    nodes = torch.cartesian_prod(*(torch.arange(count, dtype=torch.int32) for count in COUNTS)).T
    sides, exact = (of(bricks.find(nodes)).view(COUNTS).tolist() for of in (bricks.sides, bricks.exact))
    for x, y, z in itertools.product(*INNER):
        for axis in range(3):
            end = [x, y, z]
            end[axis] += 1
            if {sides[x][y][z], sides[end[0]][end[1]][end[2]]} != {1, 2}:
                continue
            for a, b, c in ((x, y, z), tuple(end)):
                if not exact[a][b][c]:
                    wanted.add((a, b, c))
            reach = [(0, 1) if other == axis else (-1, 0, 1) for other in range(3)]
            for i, j, k in itertools.product(*reach):
                if sides[x + i][y + j][z + k] == UNKNOWN:
                    wanted.add((x + i, y + j, z + k))
    return wanted


@pytest.mark.parametrize("known", [1.0, 0.95, 0.6, 0.05])
def test_wanted(known):
    bricks = noise(known)
    expected = reference(bricks)
    some, ends, edges = flood.crossings(bricks, Crew(), piece=3)
    found = bricks.nodes(flood.wanted(bricks, ends, edges))
    assert some
    assert set(zip(*found.tolist(), strict=True)) == expected
    assert found.shape[1] == len(expected)

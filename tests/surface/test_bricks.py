"""The store finds what was put there, and nothing elsewhere."""

import torch

from weingarten.surface.bricks import INSIDE, OUTSIDE, UNKNOWN, VOLUME, Bricks


def filled():
    """Bricks of some nodes of a lattice of 40 × 21 × 30, with their values."""
    generator = torch.Generator().manual_seed(0)
    nodes = torch.stack([torch.randint(0, count, (200,), generator=generator) for count in (40, 21, 30)])
    nodes = torch.unique(nodes, dim=1).to(torch.int32)
    bricks = Bricks((40, 21, 30), torch.device("cpu"))
    bricks.cover(nodes)
    bricks.grow()
    values = torch.randn(nodes.shape[1], generator=generator)
    bricks.assign(bricks.find(nodes), values)
    return bricks, nodes, values


def test_nodes_are_found_again():
    bricks, nodes, values = filled()
    addresses = bricks.find(nodes)
    assert (addresses >= VOLUME).all()
    assert torch.equal(bricks.nodes(addresses), nodes)
    assert torch.equal(bricks.at(addresses), torch.stack([values, -values]))
    assert bricks.exact(addresses).all()
    assert torch.equal(bricks.sides(addresses) == INSIDE, values < 0)


def test_blocks_are_runs_of_nodes_and_reach_beyond_the_lattice():
    bricks, nodes, _ = filled()
    firsts = torch.cat([nodes - 3, torch.tensor([[-1], [-1], [-1]], dtype=torch.int32)], dim=1)
    steps = torch.cartesian_prod(*[torch.arange(5, dtype=torch.int32)] * 3).T
    every = (firsts[:, :, None] + steps[:, None, :]).flatten(1)
    assert torch.equal(bricks.block(firsts, 5), bricks.find(every))


def test_what_does_not_exist_is_unknown():
    bricks = Bricks((40, 21, 30), torch.device("cpu"))
    bricks.cover(torch.tensor([[9], [9], [9]], dtype=torch.int32))
    bricks.grow()
    nodes = torch.tensor([[9, 9, 0, 39], [9, 10, 0, 20], [9, 9, 0, 29]], dtype=torch.int32)
    addresses = bricks.find(nodes)
    assert (addresses < VOLUME).tolist() == [False, False, True, True]
    assert (bricks.sides(addresses) == UNKNOWN).all()


def test_bounds_that_contradict_each_other_say_nothing():
    bricks, nodes, _ = filled()
    address = bricks.find(nodes[:, :3])
    bricks.bounds[:, address] = torch.tensor([[0.1, 0.1, -0.1], [0.2, -0.2, 0.3]])
    assert bricks.sides(address).tolist() == [UNKNOWN, OUTSIDE, INSIDE]

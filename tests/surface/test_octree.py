"""What the octree knows is true and enough, and it stays where the field lives."""

import numpy as np
import pytest
import torch
from torch.overrides import TorchFunctionMode
from torch.utils._pytree import tree_leaves, tree_map_only

from weingarten.calculus.exact import Sphere, Torus
from weingarten.crew import Crew
from weingarten.surface import flood
from weingarten.surface.bricks import INSIDE, OUTSIDE, VOLUME
from weingarten.surface.contour import extraction
from weingarten.surface.lattice import Lattice
from weingarten.surface.octree import Octree

LOWER, UPPER = np.full(3, -1.1), np.array([1.1, 0.93, 0.77])
TORUS = Torus(axis=(1.0, 2.0, 3.0), ring=0.6, tube=0.25)


def dense(octree):
    """The closed field at every node of the lattice, and what the octree has there."""
    lattice = octree.lattice
    nodes = np.stack(np.meshgrid(*(np.arange(n + 1) for n in lattice.cells), indexing="ij"), axis=-1)
    positions = torch.from_numpy(lattice.positions(nodes.reshape(-1, 3)).astype(np.float32))
    depth = lattice.depths(nodes.reshape(-1, 3))
    box = torch.from_numpy((-octree.slope * lattice.step * depth).astype(np.float32))
    field = TORUS(positions).maximum(box).view([n + 1 for n in lattice.cells])
    addresses = octree.bricks.find(torch.from_numpy(nodes.reshape(-1, 3).T.astype(np.int32)))
    return field, addresses.view(field.shape)


@pytest.mark.parametrize("crew", [Crew(), Crew(2)])
def test_bounds_hold_and_every_change_of_sign_has_its_values(crew):
    octree = Octree(TORUS, Lattice.over(LOWER, UPPER, 130), 1 << 14, crew)
    octree.refine()
    field, addresses = dense(octree)
    low, negative = octree.bricks.at(addresses.view(-1)).view(2, *field.shape)
    small = 2e-6 * octree.lattice.step + 1e-7
    assert (low <= field + small).all()
    assert (negative <= small - field).all()
    sides = octree.bricks.sides(addresses.view(-1)).view(field.shape)
    for axis in range(3):
        below, above = (slice(None),) * axis + (slice(-1),), (slice(None),) * axis + (slice(1, None),)
        changes = (field[below] > 0) != (field[above] > 0)
        assert changes.sum() > 1000
        assert torch.equal((sides[below] | sides[above]) == (OUTSIDE | INSIDE), changes)
        for end in (addresses[below][changes], addresses[above][changes]):
            assert (end >= VOLUME).all()
            assert octree.bricks.exact(end).all()


def test_where_the_slope_bounds_the_field_the_flood_only_asks_for_ends(monkeypatch):
    monkeypatch.setattr(Octree, "_flood", lambda self: None)
    octree = Octree(TORUS, Lattice.over(LOWER, UPPER, 130), 1 << 14, Crew())
    octree.refine()
    some, ends, edges = flood.crossings(octree.bricks, Crew(), octree.piece)
    assert some
    assert 0 < len(ends) < octree.evaluations
    assert [axis.shape[1] for axis in edges] == [0, 0, 0]


class There(torch.Tensor):
    """A tensor on another device, as far as `Apart` is concerned."""


class Apart(TorchFunctionMode):
    """Refuses operations on tensors of two devices, and counts what is fetched by the CPU.

    Tensors are There that `to(device)` made, or a `device=`, or an operation on such.
    """

    def __init__(self):
        super().__init__()
        self.fetched = []

    def __torch_function__(self, func, types, args=(), kwargs=None):
        kwargs = kwargs or {}
        with torch._C.DisableTorchFunctionSubclass():
            result = func(*args, **kwargs)
        tensors = [leaf for leaf in tree_leaves((args, kwargs)) if isinstance(leaf, torch.Tensor)]
        there = [tensor for tensor in tensors if isinstance(tensor, There)]
        if func is torch.Tensor.cpu:
            self.fetched.append(result.numel())
            return result.as_subclass(torch.Tensor)
        assert not there or func not in (torch.Tensor.numpy, torch.Tensor.tolist)
        assert not there or all(isinstance(tensor, There) or tensor.dim() == 0 for tensor in tensors), func
        sent = func is torch.Tensor.to and any(isinstance(arg, torch.device) for arg in args)
        if there or sent or kwargs.get("device") is not None:
            return tree_map_only(torch.Tensor, lambda tensor: tensor.as_subclass(There), result)
        return result


def test_only_crossed_cells_leave_the_device_of_the_field():
    sphere = Sphere(radius=0.7)
    expected = extraction(sphere, LOWER, UPPER, 130)

    def values(points):
        return torch.Tensor(sphere(points.as_subclass(torch.Tensor))).as_subclass(There)

    with Apart() as apart:
        found = extraction(values, LOWER, UPPER, 130)
    assert np.array_equal(found.mesh.vertices, expected.mesh.vertices)
    assert np.array_equal(found.mesh.faces, expected.mesh.faces)
    coarse, probes, corners, nodes, numbers = apart.fetched
    assert coarse < 40**3
    assert probes == 6 * 2048
    assert corners < 5 * len(found.mesh.faces)
    assert nodes == 3 * numbers
    assert numbers < 3 * len(found.mesh.vertices)

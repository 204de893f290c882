"""Parts drawn together draw what each would draw alone."""

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree

from weingarten.scan.draws import REACH, CloudDraws, MeasuredDraws, SignedDraws
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.generators import Generators
from weingarten.scan.interleaved import Interleaved
from weingarten.scan.oriented_draws import OrientedDraws
from weingarten.scan.sample import OFF_SURFACE, SURFACE


def ball(count, seed):
    drawn = np.random.default_rng(seed).normal(size=(count, 3))
    return drawn / np.linalg.norm(drawn, axis=1)[:, None]


def seeded(seed):
    return torch.Generator().manual_seed(seed)


def cloud_draws(count, seed):
    points = ball(count, seed)
    return CloudDraws(points, KDTree(points))


def signed_draws(count, seed):
    points = ball(count, seed)
    tree = KDTree(points)
    return SignedDraws(points, tree, FreeSpace.of(points, tree, REACH), seeded(seed))


def measured_draws(count, seed):
    points = ball(count, seed)
    return MeasuredDraws(points, KDTree(points), seeded(seed))


def oriented_draws(count, seed):
    points = ball(count, seed)
    tree = KDTree(points)
    return OrientedDraws(points, tree, FreeSpace.of(points, tree, REACH), seeded(seed))


@pytest.mark.parametrize("build", [cloud_draws, signed_draws, measured_draws, oriented_draws])
@pytest.mark.parametrize("count", [50, 400])
def test_row_k_holds_the_kth_point_of_each_part(build, count):
    members = [build(300 + 100 * i, i) for i in range(3)]
    generators = Generators([seeded(10 + i) for i in range(3)])
    apart = [seeded(10 + i) for i in range(3)]
    together = Interleaved(members)
    for _ in range(2):
        found = together(count, generators)
        for i, (draws, generator) in enumerate(zip(members, apart, strict=True)):
            expected = draws(count, generator)
            assert list(found) == list(expected)
            for name, sample in expected.items():
                assert found[name].points.shape == (count, 3, 3)
                assert torch.equal(found[name].points[:, i], sample.points)
                assert torch.equal(found[name].angles[:, i], sample.angles)
                assert found[name].tensors.keys() == sample.tensors.keys()
        assert ("distance" in found[OFF_SURFACE].tensors) == (build in (signed_draws, oriented_draws))
        assert ("normals" in found[SURFACE].tensors) == (build is oriented_draws)
        assert ("unsigned" in found[OFF_SURFACE].tensors) == (build is measured_draws)


def test_distances_go_with_their_points():
    members = [signed_draws(300, i) for i in range(2)]
    found = Interleaved(members)(60, Generators([seeded(1), seeded(2)]))[OFF_SURFACE]
    for i in range(2):
        expected = members[i](60, seeded(1 + i))[OFF_SURFACE]
        assert torch.equal(found.distance[:, i].nan_to_num(9), expected.distance.nan_to_num(9))


def test_the_state_of_many_generators_is_restored():
    generators = Generators([seeded(1), seeded(2)])
    draws = Interleaved([cloud_draws(300, 0), cloud_draws(300, 1)])
    state = generators.get_state()
    first = draws(20, generators)
    generators.set_state(state)
    again = draws(20, generators)
    for name, sample in first.items():
        assert torch.equal(sample.points, again[name].points)
        assert torch.equal(sample.angles, again[name].angles)

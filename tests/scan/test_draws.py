"""What each domain's draws are: where they lie, how they are spread, and that a seed repeats them."""

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree
from trimesh.creation import box
from trimesh.sample import sample_surface

from weingarten.scan.draws import (
    POOL,
    REACH,
    CloudDraws,
    MeasuredDraws,
    SignedDraws,
    neighbour_distance,
    spread,
    uniform_in_box,
)
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.open_boundary import rims
from weingarten.scan.oriented_draws import OrientedDraws
from weingarten.scan.sample import NEAR, OFF_SURFACE, SURFACE, Sample


def ball(count, seed=0):
    drawn = np.random.default_rng(seed).normal(size=(count, 3))
    return drawn / np.linalg.norm(drawn, axis=1)[:, None]


@pytest.fixture(scope="module")
def cloud():
    return ball(3000)


@pytest.fixture(scope="module")
def tree(cloud):
    return KDTree(cloud)


@pytest.fixture(scope="module")
def draws(cloud, tree):
    return CloudDraws(cloud, tree)


def seeded(seed=0):
    return torch.Generator().manual_seed(seed)


def test_one_sample_for_each_domain(draws):
    samples = draws(100, seeded())
    assert list(samples) == [SURFACE, OFF_SURFACE, NEAR]
    assert all(sample.points.shape == (100, 3) for sample in samples.values())
    assert all(sample.points.dtype == torch.float32 for sample in samples.values())
    assert all(sample.distance is None for sample in samples.values())


def test_surface_draws_are_points_of_the_cloud_without_repeats(draws, cloud):
    drawn = draws(3000, seeded())[SURFACE].points
    expected = torch.from_numpy(cloud.astype(np.float32))
    assert torch.equal(drawn.unique(dim=0), expected.unique(dim=0))
    assert not torch.equal(drawn, expected)


def test_more_draws_than_points(draws, cloud):
    """Ten times as many: ten of every point."""
    samples = draws(30_000, seeded())
    assert all(len(sample) == 30_000 for sample in samples.values())
    _, counts = samples[SURFACE].points.unique(dim=0, return_counts=True)
    assert counts.tolist() == [10] * len(cloud)


@pytest.mark.parametrize(("count", "total"), [(1000, 3000), (7, 10), (10, 7), (1, 5), (300, 10_000_000)])
def test_a_spread_has_one_of_every_stretch_in_random_order(count, total):
    found = spread(count, total, seeded())
    assert found.dtype == torch.int64
    ends = np.arange(count + 1) * (total / count)
    ordered = found.sort().values.numpy()
    assert (ordered >= np.floor(ends[:-1])).all()
    assert (ordered < ends[1:]).all()
    assert count == 1 or not torch.equal(found, found.sort().values)


def test_a_spread_finds_every_index_equally_often():
    generator = seeded()
    found = torch.cat([spread(30, 100, generator) for _ in range(3000)])
    counts = found.bincount(minlength=100)
    assert counts.double().mean() == 900
    assert (counts - 900).abs().max() < 5 * 30


def test_sigma_is_the_distance_to_the_fiftieth_neighbour(cloud, tree):
    expected = np.sort(np.linalg.norm(cloud[:40, None] - cloud[None], axis=2), axis=1)[:, 50]
    found = neighbour_distance(tree, cloud, 50)
    np.testing.assert_allclose(found[:40], expected, rtol=1e-12)
    np.testing.assert_array_equal(found, neighbour_distance(tree, cloud, 50, block=7 * 101))


def test_sigma_in_a_small_cloud_is_the_distance_to_the_last_one():
    few = ball(10)
    expected = np.linalg.norm(few[:, None] - few[None], axis=2).max(axis=1)
    np.testing.assert_allclose(neighbour_distance(KDTree(few), few, 50), expected)


def test_near_draws_are_normal_around_the_surface_draws(cloud, tree, draws):
    samples = draws(3000, seeded())
    where = tree.query(samples[SURFACE].points.double().numpy())[1]
    sigma = neighbour_distance(tree, cloud, 50)[where]
    noise = (samples[NEAR].points - samples[SURFACE].points).double().numpy() / sigma[:, None]
    assert abs(noise.mean()) < 0.04
    np.testing.assert_allclose(noise.std(axis=0), 1.0, rtol=0.04)
    assert np.abs(np.corrcoef(noise.T) - np.eye(3)).max() < 0.07
    assert np.mean(noise**4) == pytest.approx(3.0, rel=0.12)


def test_off_surface_draws_are_uniform_in_the_box(draws):
    drawn = draws(30_000, seeded())[OFF_SURFACE].points
    assert drawn.abs().max() <= REACH == 1.1
    assert drawn.abs().amax(dim=0).min() > 0.99 * REACH
    for axis in range(3):
        counts = torch.histc(drawn[:, axis], 10, -REACH, REACH)
        assert (counts / 3000 - 1).abs().max() < 0.07
    assert torch.corrcoef(drawn.T).fill_diagonal_(0).abs().max() < 0.03


def test_the_generator_alone_decides(draws):
    first, again, other = draws(50, seeded(3)), draws(50, seeded(3)), draws(50, seeded(4))
    for name in (SURFACE, OFF_SURFACE, NEAR):
        assert torch.equal(first[name].points, again[name].points)
        assert not torch.equal(first[name].points, other[name].points)


def test_steps_differ(draws):
    generator = seeded()
    assert not torch.equal(draws(50, generator)[NEAR].points, draws(50, generator)[NEAR].points)


def test_signed_draws_know_the_distance_where_free_space_does(cloud, tree):
    space = FreeSpace.of(cloud, tree, REACH)
    sample = SignedDraws(cloud, tree, space, seeded())(4000, seeded())[OFF_SURFACE]
    assert sample.distance is not None
    known = ~sample.distance.isnan()
    assert 0.3 < known.float().mean() < 0.95
    radius = sample.points[known].norm(dim=1)
    distance = sample.distance[known]
    assert torch.equal(distance.sign(), (radius - 1).sign())
    assert distance.abs().min() > 0.5 * space.shell
    # never less than the distance d to the sphere; with holes of radius h ≤ τ/1.3, about h²/2d more, d ≥ τ
    excess = distance.abs() - (radius - 1).abs()
    assert excess.min() > -1e-6
    assert excess.max() < 0.5 * space.shell


def test_signed_draws_repeat_with_their_generators(cloud, tree):
    space = FreeSpace.of(cloud, tree, REACH)
    pairs = [SignedDraws(cloud, tree, space, seeded(1))(50, seeded(2))[OFF_SURFACE] for _ in range(2)]
    assert torch.equal(pairs[0].points, pairs[1].points)
    assert torch.equal(pairs[0].distance.nan_to_num(9), pairs[1].distance.nan_to_num(9))


def test_oriented_draws_know_normals_and_signs_next_to_the_cloud(cloud, tree):
    space = FreeSpace.of(cloud, tree, REACH)
    draws = OrientedDraws(cloud, tree, space, seeded())
    samples = draws(4000, seeded())
    surface, off = samples[SURFACE], samples[OFF_SURFACE]
    assert samples[NEAR].normals is None
    assert surface.normals is not None
    along = (surface.normals * surface.points).sum(1)
    assert torch.allclose(along, surface.normals.norm(dim=1), atol=0.02)
    known = ~off.distance.isnan()
    distance, radius = off.distance[known], off.points[known].norm(dim=1)
    within = distance.abs() < 0.5 * space.shell
    assert 0.15 < within.float().mean() < 0.5
    # a plane of normal m through a point of the sphere errs by less than half the square of the way to it
    assert ((distance - (radius - 1))[within]).abs().max() < 0.5 * space.shell**2 + 0.02
    assert (distance.sign() == (radius - 1).sign())[distance.abs() > 0.1 * space.shell].all()


def test_oriented_draws_are_signed_draws_where_no_normal_is_known(cloud, tree):
    """With one sign for all witnesses there is none to believe: an open sheet."""
    sheet = cloud * np.array([1.0, 1.0, 0.0]) * 0.9
    open_tree = KDTree(sheet)
    space = FreeSpace.of(sheet, open_tree, REACH)
    draws = OrientedDraws(sheet, open_tree, space, seeded())
    assert draws.normals.norm(dim=1).median() < 0.05
    assert len(draws.pool) <= POOL


def test_oriented_draws_tell_what_lies_beyond_a_rim():
    """A block of which a corner was not scanned is solid up to where its faces meet."""
    upper = np.array([0.9, 0.7, 0.5])
    points = np.asarray(sample_surface(box(2.0 * upper), 20_000, seed=0)[0], dtype=np.float64)
    points = points[np.linalg.norm(points - upper, axis=1) > 0.4]
    own = KDTree(points)
    space = FreeSpace.of(points, own, REACH)
    draws = OrientedDraws(points, own, space, seeded(), rims=rims(points))
    pool, distance = draws.pool.double().numpy(), draws.distance.numpy()
    assert len(pool) == len(distance) <= POOL
    missing = (np.linalg.norm(pool - upper, axis=1) < 0.35) & (pool < upper - 0.03).all(axis=1)
    told = distance[missing & ~np.isnan(distance)]
    assert len(told) > 200
    assert (told < 0.0).mean() > 0.95


def test_without_rims_nothing_else_is_drawn(cloud, tree):
    space = FreeSpace.of(cloud, tree, REACH)
    plain, none = (OrientedDraws(cloud, tree, space, seeded(), rims=found) for found in ((), rims(cloud)))
    assert rims(cloud) == ()
    assert torch.equal(plain.pool, none.pool)


def test_measured_draws_know_the_distance_to_the_cloud(cloud, tree):
    samples = MeasuredDraws(cloud, tree, seeded())(2000, seeded())
    assert samples[SURFACE].unsigned is None
    for name in (OFF_SURFACE, NEAR):
        expected = tree.query(samples[name].points.numpy())[0]
        assert samples[name].unsigned is not None
        assert abs(samples[name].unsigned.numpy() - expected).max() < 1e-6
    assert samples[NEAR].unsigned.mean() < samples[OFF_SURFACE].unsigned.mean()


def test_samples_split_into_consecutive_pieces():
    points, distance = uniform_in_box(10, seeded()), torch.arange(10.0)
    pieces = Sample(points, distance).split(4)
    assert [len(piece) for piece in pieces] == [4, 4, 2]
    assert torch.equal(torch.cat([piece.points for piece in pieces]), points)
    assert torch.equal(torch.cat([piece.distance for piece in pieces]), distance)
    assert [piece.distance for piece in Sample(points).split(4)] == [None] * 3
    moved = Sample(points, distance).to(torch.device("cpu"))
    assert torch.equal(moved.distance, distance)


def test_draws_move_with_all_that_they_hold(cloud, tree):
    draws = OrientedDraws(cloud, tree, FreeSpace.of(cloud, tree, REACH), seeded())
    held = [name for name, value in vars(draws).items() if isinstance(value, torch.Tensor)]
    assert len(held) == 5
    draws.move(torch.device("meta"))
    assert all(getattr(draws, name).is_meta for name in held)

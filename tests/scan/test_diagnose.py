"""A usable cloud passes unchanged in every frame; each thing that can be wrong is told in one sentence."""

import re
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.errors import CloudError
from weingarten.io import coincident as sorting
from weingarten.scan import diagnose as module
from weingarten.scan.diagnose import LEAST_POINTS, diagnose

FRAMES = [(1.0, 0.0), (1.0, 1e6), (1e-5, 0.0), (1e-5, 1.0), (1e-5, 1e3), (1e150, 0.0), (1e-150, 0.0)]


def cloud(n: int = 500, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(n, 3))


def rotation(seed: int = 0) -> np.ndarray:
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]


def complaint(points: np.ndarray) -> str:
    with pytest.raises(CloudError) as caught:
        diagnose(points)
    message = str(caught.value)
    assert message.endswith(".")
    assert len(re.findall(r"\.(?:\s|$)", message)) == 1
    return message


@pytest.mark.parametrize(("scale", "offset"), FRAMES)
def test_a_good_cloud_passes_unchanged(scale, offset):
    points = cloud() * scale + offset
    result = diagnose(points)
    np.testing.assert_array_equal(result.points, points)
    assert result.notes == ()


@pytest.mark.parametrize(("scale", "offset"), FRAMES)
def test_a_thin_sheet_is_no_plane(scale, offset):
    if abs(offset) * 1e-16 > 1e-6 * scale:
        pytest.skip("a sheet of a thousandth of the part is within rounding here")
    diagnose((cloud() * [1, 1, 1e-3]) @ rotation() * scale + offset)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("scale", "offset"), FRAMES)
@pytest.mark.parametrize(("used", "reason"), [(1, "on one line"), (2, "in one plane")])
def test_lines_and_planes(scale, offset, used, reason, seed):
    flat = cloud(seed=seed) * (np.arange(3) < used)
    assert reason in complaint(flat @ rotation(seed) * scale + offset * np.array([1, -0.7, 0.3]))


def test_a_plane_rounded_to_single_precision_is_still_one():
    flat = (cloud() * [1, 1, 0]) @ rotation()
    assert "in one plane" in complaint(flat.astype(np.float32).astype(np.float64))


def test_identical_points():
    assert "All 500 points are identical" in complaint(np.full((500, 3), 0.1))
    assert "identical up to rounding" in complaint(1e6 + 1e-10 * cloud(5000).round(1))


@pytest.mark.parametrize("n", [0, 1, 2, LEAST_POINTS - 1])
def test_too_few(n):
    assert f"{n} distinct points" in complaint(cloud(n))


def test_too_few_once_duplicates_are_merged():
    assert "90 distinct points" in complaint(np.tile(cloud(90), (3, 1)))


def test_just_enough():
    assert len(diagnose(cloud(LEAST_POINTS)).points) == LEAST_POINTS


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_few_rows_that_are_not_finite_are_dropped(bad):
    points = cloud()
    points[[3, 77, 401, 402], [0, 1, 2, 0]] = bad
    result = diagnose(points)
    np.testing.assert_array_equal(result.points, np.delete(points, [3, 77, 401, 402], axis=0))
    assert result.notes == ("4 of 500 points are not finite; dropped.",)
    points[5] = bad
    assert "5 of 500 points are not finite" in complaint(points)


def test_duplicates_keep_their_first_place():
    points = cloud()
    repeated = np.concatenate([points[:300], points[100:200], points[300:], points[:1]])
    result = diagnose(repeated)
    np.testing.assert_array_equal(result.points, points)
    assert result.notes == ("101 of 601 points repeat another exactly; merged.",)


def test_both_notes():
    points = np.concatenate([cloud(), cloud()[:5], [[np.nan] * 3] * 2])
    assert len(diagnose(points).notes) == 2


def test_zeros_of_either_sign_are_one_point():
    points = cloud()
    points[:2] = [[0.0, 1.0, 0.0], [-0.0, 1.0, -0.0]]
    assert len(diagnose(points).points) == 499


@given(st.lists(st.integers(0, 6), min_size=110, max_size=200), st.integers(0, 9))
@settings(max_examples=50, deadline=None)
def test_merging_against_the_obvious_way(picks, seed):
    lattice = np.concatenate([cloud(120, seed), np.array(picks)[:, None] * [1.0, 0.0, 2.0]])
    points = np.random.default_rng(seed).permutation(lattice)
    seen = list(dict.fromkeys(map(tuple, points.tolist())))
    np.testing.assert_array_equal(diagnose(points).points, seen)


@pytest.mark.parametrize("shape", [(500,), (500, 2), (500, 4), (5, 100, 3)])
def test_other_shapes(shape):
    assert "shape" in complaint(np.ones(shape))


@pytest.mark.parametrize("block", [101, 250, 10_000])
def test_blocks_give_the_deviations_of_the_whole(block, monkeypatch):
    monkeypatch.setattr(module, "_BLOCK", block)
    points = (cloud() * [1, 1e-2, 1e-4] + [3, 0, 0]) @ rotation()
    centred = (points - points.mean(axis=0)) / 7
    expected = np.linalg.svd(centred, compute_uv=False) / np.sqrt(len(points))
    found = module._deviations(points, np.array([0.5, -2.0, 1.0]), 7.0)
    np.testing.assert_allclose(found, expected, rtol=1e-9)


@pytest.mark.parametrize("block", [101, 250])
@pytest.mark.parametrize(("used", "reason"), [(1, "on one line"), (2, "in one plane")])
def test_lines_and_planes_across_blocks(used, reason, block, monkeypatch):
    monkeypatch.setattr(module, "_BLOCK", block)
    flat = (cloud() * (np.arange(3) < used)) @ rotation()
    assert reason in complaint(flat * 1e-5 + 1.0)


def test_memory_is_less_than_twice_the_clouds_own_more():
    points = cloud(500_000)
    tracemalloc.start()
    try:
        diagnose(points)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 2 * points.nbytes


def test_only_points_whose_keys_meet_are_compared(monkeypatch):
    asked = []
    compare = sorting.coincident

    def counted(points):
        asked.append(len(points))
        return compare(points)

    monkeypatch.setattr(sorting, "coincident", counted)
    points = cloud(20_000)
    assert len(diagnose(np.concatenate([points, points[:30]])).points) == 20_000
    assert asked == [60]
    monkeypatch.setattr(sorting, "keys", lambda points: np.zeros(len(points), dtype=np.uint64))
    np.testing.assert_array_equal(diagnose(np.concatenate([points[:500], points[:30]])).points, points[:500])
    assert asked == [60, 530]

"""Beyond rims surfaces go on as they end: exact corners, edges and walls with a hole in the scan."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from weingarten.scan.continuation import AROUND, BEFORE, FEWEST, NEAREST, SPAN, Continuation
from weingarten.scan.open_boundary import rims

SIDES = np.concatenate([np.eye(3), -np.eye(3)])


def block(lower, upper, count, seed=0):
    """Uniform on a box, with outward normals."""
    random = np.random.default_rng(seed)
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    sizes = upper - lower
    areas = np.tile([sizes[1] * sizes[2], sizes[0] * sizes[2], sizes[0] * sizes[1]], 2)
    side = random.choice(6, count, p=areas / areas.sum())
    points = lower + random.random((count, 3)) * sizes
    axis = side % 3
    points[np.arange(count), axis] = np.where(side < 3, upper[axis], lower[axis])
    return points, SIDES[side]


def in_block(points, lower, upper):
    return ((points > lower) & (points < upper)).all(axis=1)


def torn(points, normals, centre, radius):
    """Continuation of a cloud without what lies in a ball."""
    left = np.linalg.norm(points - centre, axis=1) > radius
    points, normals = points[left], normals[left]
    return points, normals, Continuation.of(points, KDTree(points), normals, rims(points))


def about(centre, radius, count=2000, seed=1):
    """Uniform in a ball."""
    random = np.random.default_rng(seed)
    ways = random.standard_normal((count, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    return centre + radius * ways * random.random((count, 1)) ** (1 / 3)


LOWER, UPPER = np.array([-1.0, -0.8, -0.6]), np.array([1.0, 0.8, 0.6])


@pytest.mark.parametrize(
    "centre",
    [(1.0, 0.8, 0.6), (0.2, 0.8, 0.6), (0.1, 0.1, 0.6)],
    ids=["a corner", "an edge", "a face"],
)
def test_a_hole_in_the_scan_of_a_block(centre):
    points, normals = block(LOWER, UPPER, 30_000)
    _, _, onward = torn(points, normals, np.array(centre), 0.35)
    places = about(np.array(centre), 0.3)
    told = onward.told(places)
    said = ~np.isnan(told)
    inside = in_block(places, LOWER, UPPER)
    assert said.mean() > 0.9
    assert ((told < 0.0) == inside)[said].mean() > 0.97
    away = np.abs(np.concatenate([places - LOWER, places - UPPER], axis=1)).min(axis=1)
    assert ((told < 0.0) == inside)[said & (away > 0.03)].all()


def test_the_value_is_the_distance_to_the_face():
    points, normals = block(LOWER, UPPER, 30_000)
    _, _, onward = torn(points, normals, np.array([0.1, 0.1, 0.6]), 0.35)
    places = about(np.array([0.1, 0.1, 0.6]), 0.2)
    told = onward.told(places)
    said = ~np.isnan(told)
    assert said.all()
    np.testing.assert_allclose(told, places[:, 2] - 0.6, atol=1e-9)


def test_a_concave_edge_is_filled_up_to_both_faces():
    """An L: the inner edge runs along x at y = z = 0, and a hole is torn into it."""
    low, low_normals = block((-1, -1, -1), (1, 1, 0), 20_000)
    high, high_normals = block((-1, -1, 0), (1, 0, 1), 20_000, seed=5)
    outer = ~((np.abs(low[:, 2]) < 1e-12) & (low[:, 1] < 0.0))
    upper = ~(np.abs(high[:, 2]) < 1e-12)
    points = np.concatenate([low[outer], high[upper]])
    normals = np.concatenate([low_normals[outer], high_normals[upper]])
    centre = np.array([0.1, 0.0, 0.0])
    _, _, onward = torn(points, normals, centre, 0.3)
    assert onward.concave.any()
    assert not onward.concave.all()
    places = about(centre, 0.25)
    told = onward.told(places)
    said = ~np.isnan(told)
    inside = (places[:, 1] < 0.0) | (places[:, 2] < 0.0)
    assert said.mean() > 0.85
    assert ((told < 0.0) == inside)[said].mean() > 0.97


def test_a_hole_through_both_sides_of_a_plate():
    lower, upper = np.array([-1.0, -1.0, -0.05]), np.array([1.0, 1.0, 0.05])
    points, normals = block(lower, upper, 40_000)
    _, _, onward = torn(points, normals, np.array([0.2, 0.1, 0.0]), 0.3)
    places = about(np.array([0.2, 0.1, 0.0]), 0.25) * [1.0, 1.0, 0.5]
    told = onward.told(places)
    said = ~np.isnan(told)
    assert said.mean() > 0.95
    assert ((told < 0.0) == (np.abs(places[:, 2]) < 0.05))[said].all()


def test_nothing_stands_out_of_the_box_of_the_cloud():
    """Half a bar: its sides go on for ever."""
    points, normals = block(LOWER, UPPER, 30_000)
    half = points[:, 0] < 0.2
    points, normals = points[half], normals[half]
    onward = Continuation.of(points, KDTree(points), normals, rims(points))
    beyond = np.array([[0.3, 0.75, 0.0], [0.5, 0.0, 0.55], [0.21, 0.5, 0.3]])
    told = onward.told(beyond)
    assert (told > 0.0).all()
    assert onward.told(np.array([[0.15, 0.75, 0.0]])) < 0.0


def test_nothing_is_said_next_to_what_was_scanned():
    points, normals = block(LOWER, UPPER, 30_000)
    points, _, onward = torn(points, normals, UPPER, 0.35)
    assert np.isnan(onward.told(points[np.linalg.norm(points - UPPER, axis=1) > 0.6])).all()
    assert onward.told(np.empty((0, 3))).shape == (0,)


def test_a_few_points_are_no_rim():
    points, normals = block(LOWER, UPPER, 1000)
    tree = KDTree(points)
    assert Continuation.of(points, tree, normals, ()) is None
    assert Continuation.of(points, tree, normals, (np.arange(FEWEST - 1),)) is None
    assert Continuation.of(points, tree, normals, (np.arange(FEWEST),)) is not None
    assert Continuation.of(points, tree, 0.9 * normals, (np.arange(FEWEST),)) is None


def test_a_small_hole_says_nothing_of_places_far_away():
    points, normals = block(LOWER, UPPER, 30_000)
    centre = np.array([0.1, 0.1, 0.6])
    _, _, onward = torn(points, normals, centre, 0.12)
    height = np.array([0.1, 0.3, 0.5, 0.8, 0.9])
    told = onward.told(centre + height[:, None] * [0.0, 0.0, 1.0])
    np.testing.assert_array_equal(np.isnan(told), height > SPAN * 0.24 * np.sqrt(2.0))


def slowly(place, points, rim, normals, spans, lower, upper):
    """The formula, point by point."""
    gaps = [np.linalg.norm(place - p) for p in rim]
    if min(gaps) >= NEAREST * min(np.linalg.norm(points - place, axis=1)):
        return np.nan
    if min(gaps) >= spans[int(np.argmin(gaps))]:
        return np.nan
    chosen = [i for i in range(len(rim)) if gaps[i] <= AROUND * min(gaps)]
    height = [float(normals[i] @ (place - rim[i])) for i in range(len(rim))]

    def before(i, j):
        way = rim[j] - rim[i]
        return normals[i] @ way > BEFORE * np.linalg.norm(way)

    found = max(
        min([height[i], *(height[j] for j in chosen if before(i, j) and before(j, i))]) for i in chosen
    )
    outside = max(*(place - upper), *(lower - place))
    found = max(found, outside)
    alone = max(height[int(np.argmin(gaps))], outside)
    return float(np.clip(found, -min(gaps), min(gaps))) if alone * found > 0.0 else np.nan


def test_as_the_formula_says_point_by_point():
    random = np.random.default_rng(3)
    points = random.uniform(-1, 1, (40, 3))
    normals = random.standard_normal((40, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    own = (np.arange(0, 26, 2), np.array([26, 28, 30]), np.arange(32, 40, 2))
    points[own[1]] = 0.1 * points[own[1]]
    chosen = np.concatenate(own)
    spans = np.concatenate([[SPAN * np.linalg.norm(np.ptp(points[rim], axis=0))] * len(rim) for rim in own])
    onward = Continuation.of(points, KDTree(points), normals, own)
    places = random.uniform(-1.2, 1.2, (300, 3))
    lower, upper = points.min(axis=0), points.max(axis=0)
    rest = (points, points[chosen], normals[chosen], spans, lower, upper)
    expected = [slowly(place, *rest) for place in places]
    told = onward.told(places)
    assert 0.1 < np.isnan(told).mean() < 0.9
    assert onward.concave.any()
    np.testing.assert_allclose(told, expected, atol=1e-12)

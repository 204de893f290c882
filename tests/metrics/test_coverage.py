"""What speaks against a mesh without a ground truth: surface without points, points without surface."""

import numpy as np
import pytest
from trimesh.creation import box, icosphere

from weingarten.mesh import Mesh
from weingarten.metrics.coverage import PATCH, SHARE_GUESSED, SHARE_MISSED, coverage, largest_patch
from weingarten.metrics.distance import closest
from weingarten.scan.sampling import sample_surface


def mesh_of(shape):
    return Mesh(np.asarray(shape.vertices, dtype=np.float64), np.asarray(shape.faces, dtype=np.int64))


BALL = mesh_of(icosphere(5))
PLATE = mesh_of(box((2.0, 2.0, 0.02)))


def seen(mesh, points, noise=0.0):
    return coverage(mesh, points, closest(mesh, points).distance, noise)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("mesh", [BALL, PLATE], ids=["ball", "plate"])
@pytest.mark.parametrize("count", [1000, 20_000])
def test_nothing_speaks_against_the_surface_that_was_sampled(mesh, count, seed):
    found = seen(mesh, sample_surface(mesh, count, seed)[0])
    assert found.guessed < 0.1 * SHARE_GUESSED
    assert found.missed == 0.0
    assert found.doubts == ()


def test_density_that_changes_tenfold_is_no_hole():
    points = sample_surface(BALL, 40_000, 0)[0]
    kept = (points[:, 2] > 0) | (np.arange(len(points)) % 10 == 0)
    assert seen(BALL, points[kept]).guessed < SHARE_GUESSED


@pytest.mark.parametrize("count", [3000, 30_000])
def test_a_cap_that_was_not_scanned_is_a_guess(count):
    points = sample_surface(BALL, count, 0)[0]
    found = seen(BALL, points[points[:, 2] < 0.8])
    assert 0.03 < found.guessed < 0.1
    assert found.missed == 0.0
    assert len(found.doubts) == 1
    assert f"{100 * found.guessed:.1f} % of the surface" in found.doubts[0]


def test_points_without_surface_are_missed():
    other = BALL.vertices + np.array([3.0, 0.0, 0.0])
    points = np.concatenate(
        [sample_surface(BALL, 6000, 0)[0], sample_surface(Mesh(other, BALL.faces), 2000, 1)[0]]
    )
    found = seen(BALL, points)
    assert found.missed == pytest.approx(0.25)
    assert any("25.0 % of the points" in doubt for doubt in found.doubts)


@pytest.mark.parametrize("deviation", [0.002, 0.01, 0.03])
def test_noise_is_neither(deviation):
    points = sample_surface(BALL, 20_000, 0)[0]
    points = points + deviation * np.random.default_rng(0).normal(size=points.shape)
    found = seen(BALL, points, noise=deviation * np.sqrt(2.0 / np.pi))
    assert found.guessed < SHARE_GUESSED
    assert found.missed < SHARE_MISSED


def test_it_is_the_same_in_any_unit():
    points = sample_surface(BALL, 2000, 0)[0]
    points = points[points[:, 0] < 0.7]
    far = Mesh(25.4 * BALL.vertices + 1000.0, BALL.faces)
    assert seen(far, 25.4 * points + 1000.0).guessed == pytest.approx(seen(BALL, points).guessed, abs=1e-3)


def test_a_small_hole_that_was_closed_is_said_with_its_place():
    mesh, points = mesh_of(box((2.0, 2.0, 0.2))), sample_surface(mesh_of(box((2.0, 2.0, 0.2))), 20_000, 0)[0]
    around = np.hypot(points[:, 0] - 0.5, points[:, 1]) < 0.05
    turn = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    wall = np.column_stack([0.5 + 0.05 * np.cos(turn), 0.05 * np.sin(turn), np.linspace(-0.09, 0.09, 60)])
    found = seen(mesh, np.concatenate([points[~around], wall]))
    assert found.missed < SHARE_MISSED
    assert len(found.patch) >= PATCH
    np.testing.assert_allclose(found.patch.mean(axis=0), [0.5, 0.0, 0.0], atol=0.03)
    assert found.doubts == (
        f"{len(found.patch)} points in one place, around "
        f"({', '.join(f'{value:.4g}' for value in found.patch.mean(axis=0))}), are off the mesh: it misses a "
        "small hole or rib there.",
    )


def test_as_many_points_off_the_mesh_here_and_there_are_no_hole():
    strays = np.random.default_rng(0).uniform(-1.0, 1.0, (60, 3)) * 0.6
    found = seen(BALL, np.concatenate([sample_surface(BALL, 20_000, 0)[0], strays]))
    assert 0.0 < found.missed < SHARE_MISSED
    assert len(found.patch) < PATCH
    assert found.doubts == ()


def test_the_largest_patch_is_that_of_a_slow_search():
    generator = np.random.default_rng(1)
    points, reach = generator.uniform(size=(80, 3)), generator.uniform(0.05, 0.2, 80)
    group = np.arange(80)
    gaps = np.linalg.norm(points[:, None] - points, axis=-1)
    for one, other in np.argwhere(gaps <= reach[:, None]):
        group[group == group[other]] = group[one]
    sizes = np.bincount(group)
    assert len(largest_patch(points, reach)) == sizes.max()

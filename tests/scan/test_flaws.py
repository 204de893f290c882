"""Flaws of a scan: how dense it is where, what is left out, what a scanner sees."""

import functools

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.errors import InputError, OptionError
from weingarten.mesh import Mesh
from weingarten.scan.flaws import PROBE, Missing, evenly_spread, flawed, missing, uneven, visible
from weingarten.scan.sampling import sample_surface


def mesh_of(shape: trimesh.Trimesh) -> Mesh:
    """Of trimesh's."""
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


BALL = mesh_of(trimesh.creation.icosphere(5, 5.0))
OPEN_BOX = Mesh(
    np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]),
    np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]),
)


def draw(mesh: Mesh, count: int, seed):
    """Uniform by area."""
    return sample_surface(mesh, count, seed)[0]


on_ball = functools.partial(draw, BALL)


def test_one_end_is_so_many_times_as_dense_as_the_other():
    flaw = uneven(10.0, on_ball(PROBE, 1), (2,))
    points = flawed(on_ball, 40_000, [flaw], (3,))
    assert points.shape == (40_000, 3)
    along = (points @ flaw.direction - flaw.first) / (flaw.last - flaw.first)
    share = [np.mean((along >= low) & (along < low + 0.1)) for low in (0.05, 0.85)]
    assert share[0] / share[1] == pytest.approx(10.0**0.8, rel=0.1)  # bands of a sphere have equal areas


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 0.9), st.integers(0, 100))
def test_the_missing_share_is_missing_in_one_place(share: float, seed: int):
    probe = on_ball(PROBE, 1)
    flaw = missing(share, probe, (seed,))
    assert np.mean(flaw(on_ball(PROBE, 2)) == 0) == pytest.approx(share, abs=0.02)
    points = flawed(on_ball, 5000, [flaw], (seed, 1))
    assert np.linalg.norm(points - flaw.centre, axis=1).min() > flaw.radius


def test_a_scanner_sees_the_near_side_of_a_ball_and_less_at_its_rim():
    flaw = visible(BALL, 1, (4,))
    points = on_ball(20_000, 5)
    chance = flaw(points)
    viewpoint = flaw.viewpoints[0] * flaw.size + flaw.centre
    distance = np.linalg.norm(viewpoint)
    cosine = np.einsum("nd,nd->n", points / 5.0, viewpoint - points)
    cosine /= np.linalg.norm(viewpoint - points, axis=1)
    assert distance == pytest.approx(1.5 * np.linalg.norm(np.ptp(BALL.vertices, axis=0)))
    np.testing.assert_allclose(chance[cosine > 0.05], cosine[cosine > 0.05], atol=0.04)  # faces are flat
    assert not chance[cosine < -0.05].any()


def test_what_a_face_conceals_is_not_scanned():
    """Of two parallel plates, each conceals of the other what lies behind it."""
    flaw = visible(OPEN_BOX, 1, (0,))
    flaw.viewpoints = np.array([[0.0, 0.0, 50.0]])
    assert flaw(np.array([[0.5, 0.4, 1.0], [0.5, 0.4, 0.0]])) == pytest.approx([1.0, 0.0], abs=1e-3)


def test_viewpoints_are_spread_evenly():
    directions = evenly_spread(200)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
    assert np.linalg.norm(directions.mean(axis=0)) < 0.01
    nearest = np.sort(np.linalg.norm(directions[:, None] - directions, axis=-1), axis=1)[:, 1]
    assert nearest.min() > 0.5 * np.sqrt(4 * np.pi / 200)


def test_seed_decides():
    first, second, third = (flawed(on_ball, 100, [], (seed,)) for seed in (5, 5, 6))
    assert np.array_equal(first, second)
    assert not np.array_equal(first, third)


def test_what_cannot_be_asked_for():
    probe = on_ball(100, 0)
    for call in (
        lambda: uneven(0.5, probe, (0,)),
        lambda: missing(1.0, probe, (0,)),
        lambda: visible(BALL, 0, (0,)),
    ):
        with pytest.raises(OptionError):
            call()
    with pytest.raises(InputError, match="left to scan"):
        flawed(on_ball, 100, [Missing(np.zeros(3), 10.0)], (0,))

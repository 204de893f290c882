"""field-1 against fields whose error is known: the exact one, and that with a factor, an offset, a sign."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import torch
import trimesh

sys.path.insert(0, str(Path(__file__).parent))
from shapes import NONE, TURN, as_mesh, joined, moved, opened, similar, square, turned_over

from weingarten.calculus.exact import Box, Difference, Sphere
from weingarten.errors import InputError
from weingarten.mesh import Mesh
from weingarten.metrics.field_error import FIELD, Field
from weingarten.metrics.unit_cube import unit_cube
from weingarten.world_field import FieldSample

SIDES = (2.0, 1.0, 0.5)
TRUTH = as_mesh(trimesh.creation.box(SIDES))
LONGEST = 2.0
DISTANCE = Box(half=(1.0, 0.5, 0.25))
SIGNED = ("distance_error_band", "distance_error_box", "wrong_sign_band", "wrong_sign_box")


class Sample(NamedTuple):
    distance: np.ndarray
    gradient: np.ndarray


def field(shape, factor: float = 1.0, offset: float = 0.0) -> Callable[[np.ndarray], Sample]:
    """factor · shape + offset, with its gradient by autograd in double precision."""

    def sampled(points: np.ndarray) -> Sample:
        x = torch.from_numpy(points).requires_grad_(True)
        value = factor * shape(x) + offset
        (gradient,) = torch.autograd.grad(value.sum(), x)
        return Sample(value.detach().numpy(), gradient.numpy())

    return sampled


def test_the_exact_field_has_no_error():
    found = FIELD.evaluate(field(DISTANCE), TRUTH)
    assert found.unit_length == LONGEST
    assert found.flags == ()
    values = found.values()
    del values["unit_length"]
    assert values == pytest.approx(dict.fromkeys(values, 0.0), abs=1e-9)


def test_the_exact_sphere_has_the_error_of_the_facets():
    """The truth is a polyhedron within the sphere, deepest in the middles of its faces."""
    ball = as_mesh(trimesh.creation.icosphere(5, radius=3.0))
    found = FIELD.evaluate(field(Sphere(radius=3.0)), ball)
    assert 0 < found.distance_error_band < 1e-4
    assert 0 < found.distance_error_box < 1e-4
    assert found.gradient_error_box == pytest.approx(0, abs=1e-9)
    assert found.wrong_sign_band < 0.005


def test_an_offset_is_the_distance_error():
    """f = d + 0.01 in unit-cube lengths; what is less than that within has the wrong sign."""
    found = FIELD.evaluate(field(DISTANCE, 1.0, 0.01 * LONGEST), TRUTH)
    assert found.distance_error_band == pytest.approx(0.01, abs=1e-9)
    assert found.distance_error_box == pytest.approx(0.01, abs=1e-9)
    assert found.gradient_error_band == pytest.approx(0, abs=1e-9)
    skin = np.prod(SIDES) - np.prod(np.subtract(SIDES, 2 * 0.01 * LONGEST))
    assert found.wrong_sign_box == pytest.approx(skin / np.prod(SIDES) / 1.1**3, abs=0.015)


def test_twice_the_distance_is_off_by_the_distance():
    found = FIELD.evaluate(field(DISTANCE, 2.0), TRUTH)
    assert found.gradient_error_band == pytest.approx(1, abs=1e-9)
    assert found.gradient_error_box == pytest.approx(1, abs=1e-9)
    assert (found.wrong_sign_band, found.wrong_sign_box) == (0, 0)
    unit = unit_cube(TRUTH, TRUTH)
    for points, value in (
        (FIELD.points_in_band(unit, 0), found.distance_error_band),
        (FIELD.points_in_box(unit, 0), found.distance_error_box),
    ):
        true = np.abs(field(DISTANCE)(points * LONGEST).distance) / LONGEST
        assert value == pytest.approx(true.mean(), abs=1e-12)


def test_a_field_that_is_outside_everywhere_is_wrong_inside():
    everywhere = field(DISTANCE, 0.0, 1.0)
    found = FIELD.evaluate(everywhere, TRUTH)
    assert found.wrong_sign_box == pytest.approx(1 / 1.1**3, abs=0.015)
    assert found.gradient_error_box == 1
    assert FIELD.evaluate(field(DISTANCE, -1.0), TRUTH).wrong_sign_box == 1


def test_the_band_is_a_ball_about_every_point_of_the_surface():
    """Of a plane, the mean height in a ball of radius r is 3r/8, and no point is farther than r."""
    plane = square((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    points = FIELD.points_in_band(plane, 0)
    assert points.shape == (20_000, 3)
    assert np.abs(points[:, 2]).max() < 0.05
    assert np.abs(points[:, 2]).mean() == pytest.approx(3 * 0.05 / 8, rel=0.02)
    assert points[:, 2].mean() == pytest.approx(0, abs=1e-3)


def test_the_box_is_a_tenth_longer_than_the_truths():
    unit = unit_cube(TRUTH, TRUTH)
    points = np.abs(FIELD.points_in_box(unit, 0))
    np.testing.assert_allclose(points.max(axis=0), 0.55 * np.array([1, 0.5, 0.25]), rtol=1e-3)
    np.testing.assert_allclose(points.mean(axis=0), 0.275 * np.array([1, 0.5, 0.25]), rtol=0.02)


def test_is_invariant_to_scale_and_place():
    def elsewhere(points: np.ndarray) -> Sample:
        near = field(DISTANCE, 1.3, 0.02)((points - 50.0) / 7)
        return Sample(7 * near.distance, near.gradient)

    before = FIELD.evaluate(field(DISTANCE, 1.3, 0.02), TRUTH).values()
    after = FIELD.evaluate(elsewhere, similar(TRUTH, 7, None, 50.0)).values()
    assert after.pop("unit_length") == pytest.approx(7 * before.pop("unit_length"))
    assert after == pytest.approx(before, rel=1e-9, abs=1e-12)


def test_of_a_turned_truth():
    def turned(points: np.ndarray) -> Sample:
        near = field(DISTANCE)(points @ TURN)
        return Sample(near.distance, near.gradient @ TURN.T)

    found = FIELD.evaluate(turned, similar(TRUTH, 1, TURN))
    assert (found.distance_error_box, found.wrong_sign_box) == (pytest.approx(0, abs=1e-9), 0)


def test_seeds():
    measure = field(DISTANCE, 1.3)
    assert FIELD.evaluate(measure, TRUTH, 3) == FIELD.evaluate(measure, TRUTH, 3)
    assert FIELD.evaluate(measure, TRUTH, 3) != FIELD.evaluate(measure, TRUTH, 4)


def test_inside_out_is_as_good():
    right, over = (FIELD.evaluate(field(DISTANCE, 1.3), mesh) for mesh in (TRUTH, turned_over(TRUTH)))
    assert right.wrong_sign_box == over.wrong_sign_box == 0
    assert over.distance_error_box == pytest.approx(right.distance_error_box, rel=1e-9)
    assert over.flags == ("truth-inside-out",)


def test_a_cavity_is_outside():
    hollow = joined(TRUTH, turned_over(similar(TRUTH, 0.5)))
    walls = Difference(DISTANCE, Box(half=(0.5, 0.25, 0.125)))
    found = FIELD.evaluate(field(walls), hollow)
    assert (found.wrong_sign_band, found.wrong_sign_box) == (0, 0)
    assert found.flags == ("truth-bodies",)


def one_turned() -> Mesh:
    faces = TRUTH.faces.copy()
    faces[0] = faces[0, ::-1]
    return Mesh(TRUTH.vertices, faces)


@pytest.mark.parametrize(("truth", "flag"), [(opened(TRUTH), "open"), (one_turned(), "not-oriented")])
def test_without_an_inside_only_the_gradient_is_measured(truth: Mesh, flag: str):
    found = FIELD.evaluate(field(DISTANCE, 2.0), truth)
    assert [getattr(found, name) for name in SIGNED] == [None] * 4
    assert (found.gradient_error_band, found.gradient_error_box) == (pytest.approx(1), pytest.approx(1))
    assert found.flags == (f"truth-{flag}",)
    assert json.loads(json.dumps(found.as_dict(), allow_nan=False))["distance_error_box"] is None


def test_a_field_that_is_not_finite_is_flagged():
    def torn(points: np.ndarray) -> Sample:
        found = field(DISTANCE)(points)
        found.gradient[np.abs(points).max(axis=1) > 1.0, 0] = np.inf
        found.distance[np.abs(points).max(axis=1) > 1.04] = np.nan
        return found

    found = FIELD.evaluate(torn, moved(TRUTH, 0, 0, 0))
    assert {name for name, value in found.values().items() if value is not None} == {"unit_length"}
    assert found.flags == ("field-not-finite",)
    json.dumps(found.as_dict(), allow_nan=False)


def test_no_truth_is_an_error():
    with pytest.raises(InputError, match=r"^The truth has no faces"):
        FIELD.evaluate(field(DISTANCE), NONE)


def test_takes_the_samples_of_a_fitted_field():
    def fitted(points: np.ndarray) -> FieldSample:
        found = field(DISTANCE)(points)
        return FieldSample(found.distance, found.gradient, np.zeros((len(points), 2)))

    small = Field(samples=500)
    assert small.evaluate(fitted, TRUTH) == small.evaluate(field(DISTANCE), TRUTH)

"""The five kinds: derivatives, curvatures and fits against closed forms and differences."""

import math

import numpy as np
import pytest
import torch

from weingarten.calculus import exact
from weingarten.frame import Frame
from weingarten.measure.axis import Axis
from weingarten.measure.cone import Cone
from weingarten.measure.cylinder import Cylinder
from weingarten.measure.fitting import fitted
from weingarten.measure.patch import Patch
from weingarten.measure.plane import Plane
from weingarten.measure.reach import spanned, swept
from weingarten.measure.sphere import Sphere
from weingarten.measure.surface import unit
from weingarten.measure.torus import Torus

CENTRE, LEAN = (0.1, 0.2, 0.3), (0.3, -0.5, 0.8)
AXIS = Axis(np.array(CENTRE), unit(np.array(LEAN)))
HALF = 0.5
PAIRS = (
    (Plane(AXIS.position, AXIS.direction), exact.Plane(CENTRE, LEAN)),
    (Sphere(AXIS.position, 0.7), exact.Sphere(CENTRE, 0.7)),
    (Cylinder(AXIS, 0.6), exact.Cylinder(CENTRE, LEAN, 0.6)),
    (Cone(AXIS.at(1.0), math.tan(HALF), HALF), exact.Cone(CENTRE, LEAN, HALF)),
    (Torus(AXIS, 0.8, 0.3), exact.Torus(CENTRE, LEAN, 0.8, 0.3)),
)


def on(surface, count: int, seed: int = 0) -> np.ndarray:
    """Points on a surface, of a cone on one side of its apex: random ones, moved to it."""
    points = np.random.default_rng(seed).uniform(-1, 1, (4 * count, 3)) + AXIS.position + 0.8 * AXIS.direction
    for _ in range(5):
        points = points - surface.distance(points)[:, None] * surface.normals(points)
    return points[(AXIS.height(points) > 0.05) | (surface.KIND != "cone")][:count]


@pytest.mark.parametrize(("surface", "shape"), PAIRS, ids=lambda one: getattr(one, "KIND", ""))
def test_distances_normals_and_curvatures_are_those_of_the_exact_shapes(surface, shape):
    points = on(surface, 200)
    away = points + 0.05 * surface.normals(points)
    tensor = torch.from_numpy(away).requires_grad_()
    (slope,) = torch.autograd.grad(shape(tensor).sum(), tensor)
    np.testing.assert_allclose(surface.distance(away), shape(tensor).detach().numpy(), atol=1e-12)
    np.testing.assert_allclose(surface.normals(away), slope.numpy(), atol=1e-12)
    bend = np.sort(shape.curvatures(torch.from_numpy(points)).numpy(), axis=1)
    np.testing.assert_allclose(np.sort(surface.curvatures(points), axis=1), bend, atol=1e-9)


@pytest.mark.parametrize("surface", [surface for surface, _ in PAIRS], ids=lambda one: one.KIND)
def test_slopes_are_differences_of_distances(surface):
    points, small = np.random.default_rng(1).normal(size=(40, 3)), 1e-6
    for number, step in enumerate(small * np.eye(surface.FREEDOM)):
        change = surface.moved(step).distance(points) - surface.moved(-step).distance(points)
        np.testing.assert_allclose(surface.slopes(points)[:, number], change / (2 * small), atol=1e-7)


@pytest.mark.parametrize("surface", [surface for surface, _ in PAIRS], ids=lambda one: one.KIND)
def test_a_guess_from_a_patch_with_strangers_in_it_is_fitted_exactly(surface):
    points = on(surface, 300)
    rough = np.random.default_rng(2).normal(size=points.shape)
    normals = surface.normals(points) + 0.01 * rough
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    patch = Patch(points, normals, surface.curvatures(points))
    strangers = points[:20] + 0.1
    fits = [fitted(guess, np.vstack([points, strangers]), 1e-9) for guess in type(surface).guesses(patch)]
    assert min(np.abs(fit.distance(points)).max() for fit in fits if fit is not None) < 1e-8


@pytest.mark.parametrize("surface", [surface for surface, _ in PAIRS], ids=lambda one: one.KIND)
def test_placing_in_the_world_scales_distances(surface):
    frame, points = Frame((1e6, -5.0, 2.0), 40.0), np.random.default_rng(3).normal(size=(50, 3))
    placed = surface.placed(frame).distance(frame.to_world(points))
    np.testing.assert_allclose(placed, 40.0 * surface.distance(points), atol=1e-6)


def test_angles_leave_out_the_widest_gap():
    angles = np.random.default_rng(4).uniform(0, 1.5 * np.pi, 2000)
    angle, full = swept(angles)
    assert not full
    assert angle == pytest.approx(270.0, abs=1.0)
    assert swept(np.random.default_rng(5).uniform(-np.pi, np.pi, 300)) == (360.0, True)


def test_a_span_is_right_on_average():
    draw = np.random.default_rng(6)
    assert np.mean([spanned(draw.uniform(2.0, 5.0, 20)) for _ in range(2000)]) == pytest.approx(3.0, abs=0.01)

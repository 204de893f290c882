"""Closed forms against autograd in float64: ‖∇f‖ = 1, and the Hessian's eigenvalues are the curvatures."""

import math

import pytest
import torch

from weingarten.calculus.exact import (
    Box,
    CappedCylinder,
    Cone,
    Cylinder,
    Difference,
    Intersection,
    Plane,
    Sphere,
    Torus,
    Union,
)

CENTRE, AXIS = (0.1, -0.2, 0.05), (1.0, 2.0, -2.0)
SPHERE = Sphere(CENTRE, 0.6)
CYLINDER = Cylinder(CENTRE, AXIS, 0.4)
CAPPED = CappedCylinder(CENTRE, AXIS, 0.4, 0.5)
BOX = Box(CENTRE, (0.5, 0.4, 0.3))
SMOOTH = [
    Plane(CENTRE, AXIS),
    SPHERE,
    CYLINDER,
    CAPPED,
    Cone((0.0, 0.0, -1.0), AXIS, 0.5),
    Torus(CENTRE, AXIS, 0.6, 0.2),
    BOX,
]
COMBINED = [
    Union((SPHERE, Box((0.6, 0.0, 0.0), (0.5, 0.2, 0.2)))),
    Intersection((SPHERE, Plane(CENTRE, AXIS))),
    Difference(BOX, Cylinder(CENTRE, (0.0, 0.0, 1.0), 0.2)),
    Difference(BOX, Sphere((0.5, 0.3, 0.3), 0.3)),
]


def points(count=300, seed=0):
    return 2 * torch.rand(count, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(seed)) - 1


def gradients(shape, at):
    at = at.clone().requires_grad_(True)
    return torch.autograd.grad(shape(at).sum(), at)[0]


def hessians(shape, at):
    rows = torch.autograd.functional.jacobian(lambda p: gradient_graph(shape, p).sum(dim=0), at)
    return rows.permute(1, 0, 2)


def gradient_graph(shape, at):
    return torch.autograd.grad(shape(at).sum(), at, create_graph=True)[0]


def on_surface(shape, count=3000):
    """Points moved along the gradient until the field vanishes, well inside one smooth part."""
    at = points(count)
    for _ in range(40):
        at = at - shape(at)[:, None] * gradients(shape, at)
    settled = shape(at).abs() < 1e-12
    nearby = torch.stack([shape(at + 0.02 * gradients(shape, at)), -shape(at - 0.02 * gradients(shape, at))])
    at = at[settled & ((nearby - 0.02).abs() < 1e-9).all(dim=0)]
    turn = torch.stack([gradients(shape, at + 0.005 * axis) for axis in torch.eye(3, dtype=at.dtype)])
    return at[((turn - gradients(shape, at)).norm(dim=-1) < 0.1).all(dim=0)]


@pytest.mark.parametrize("shape", SMOOTH + COMBINED)
def test_unit_gradient(shape):
    torch.testing.assert_close(gradients(shape, points()).norm(dim=1), torch.ones(300, dtype=torch.float64))


@pytest.mark.parametrize("shape", SMOOTH + COMBINED)
def test_curvatures_are_the_hessians_eigenvalues(shape):
    at = on_surface(shape)
    assert len(at) > 100
    hessian, normal = hessians(shape, at), gradients(shape, at)
    assert (hessian @ normal[:, :, None]).abs().max() < 1e-9
    expected = torch.cat([shape.curvatures(at), torch.zeros(len(at), 1, dtype=at.dtype)], dim=1)
    found = torch.linalg.eigvalsh(hessian)
    torch.testing.assert_close(found, expected.sort(dim=1).values, rtol=1e-8, atol=1e-8)
    assert (shape.curvatures(at).diff(dim=1) <= 0).all()


@pytest.mark.parametrize("shape", SMOOTH)
def test_values_are_distances(shape):
    """No point is nearer to the surface than |f|, and the foot of the gradient is on it."""
    at = points()
    feet = at - shape(at)[:, None] * gradients(shape, at)
    assert shape(feet).abs().max() < 1e-12
    nearest = torch.cdist(at, on_surface(shape)).amin(dim=1)
    assert (nearest >= shape(at).abs() - 1e-9).all()


@pytest.mark.parametrize(
    ("shape", "inside", "outside"),
    [
        (Plane(), (0, 0, -1), (0, 0, 1)),
        (SPHERE, CENTRE, (1, 1, 1)),
        (CAPPED, CENTRE, (1, 1, 1)),
        (Cone(half_angle=math.pi / 4), (0, 0, 1), (0, 0, -1)),
        (Torus(), (1, 0, 0), (0, 0, 0)),
        (COMBINED[2], (0.5, 0.1, 0.1), CENTRE),
    ],
)
def test_signs(shape, inside, outside):
    below, above = shape(torch.tensor([inside, outside], dtype=torch.float32))
    assert below < 0 < above


@pytest.mark.parametrize("shape", SMOOTH + COMBINED)
def test_dtype_is_kept_and_derivatives_are_finite_at_special_points(shape):
    special = torch.tensor([CENTRE, (0.0, 0.0, -1.0), (0.0, 0.0, 0.0)], dtype=torch.float32)
    assert shape(special).dtype == torch.float32
    assert hessians(shape, special.requires_grad_(True)).isfinite().all()

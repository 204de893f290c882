"""Every term on exact fields in float64 against its closed form, and what it must not depend on."""

import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.exact import Cone, Cylinder, Plane, Sphere, Torus
from weingarten.calculus.jet import GRADIENT, TANGENT, VALUE
from weingarten.scan.sample import NEAR, OFF_SURFACE, SURFACE, Sample
from weingarten.terms.dirichlet import DIRICHLET
from weingarten.terms.eikonal import EIKONAL, EIKONAL_ABSOLUTE
from weingarten.terms.free_space import FREE_SPACE
from weingarten.terms.off_diagonal_weingarten import OFF_DIAGONAL_WEINGARTEN
from weingarten.terms.off_surface import OFF_SURFACE_TERM

CENTRE, AXIS = (0.1, -0.2, 0.05), (1.0, 2.0, -2.0)
SHAPES = {
    "plane": Plane(CENTRE, AXIS),
    "sphere": Sphere(CENTRE, 0.6),
    "cylinder": Cylinder(CENTRE, AXIS, 0.4),
    "cone": Cone((0.0, 0.0, -3.0), (0.0, 0.0, 1.0), 0.3),
    "torus": Torus(CENTRE, AXIS, 0.6, 0.2),
}
TERMS = (DIRICHLET, OFF_SURFACE_TERM, EIKONAL, EIKONAL_ABSOLUTE, FREE_SPACE, OFF_DIAGONAL_WEINGARTEN)


class Scaled(torch.nn.Module):
    """c f of an exact field f, at points turned by a rotation."""

    def __init__(self, shape, factor=1.0, rotation=None):
        super().__init__()
        self.shape = shape
        self.factor = torch.nn.Parameter(torch.tensor(factor, dtype=torch.float64))
        self.rotation = torch.eye(3, dtype=torch.float64) if rotation is None else rotation

    def forward(self, points):
        return self.factor * self.shape(points @ self.rotation)


def draw(count=200, seed=0):
    generator = torch.Generator().manual_seed(seed)
    points = 2 * torch.rand(count, 3, dtype=torch.float64, generator=generator) - 1
    return points, 2 * math.pi * torch.rand(count, dtype=torch.float64, generator=generator)


def residuals(term, field, points, angles=None, distance=None):
    return term.residual(Autodiff(field)(points, term.order, angles), Sample(points, distance)).detach()


def near(found, expected, accuracy=1e-9):
    torch.testing.assert_close(found, expected, rtol=accuracy, atol=accuracy)


def principal(shape, points):
    """κ₁ − κ₂ of the level sets of an exact distance: k/(1 + k f) at the foot's curvatures k."""
    at = points.clone().requires_grad_(True)
    f = shape(at)
    (g,) = torch.autograd.grad(f.sum(), at)
    feet = shape.curvatures(at.detach() - f.detach()[:, None] * g)
    level = feet / (1 + feet * f.detach()[:, None])
    return level[:, 0] - level[:, 1]


def test_where_and_how_far_each_term_looks():
    """Method §2's table."""
    assert [(term.domains, term.order) for term in TERMS] == [
        ((SURFACE,), VALUE),
        ((OFF_SURFACE,), VALUE),
        ((SURFACE, NEAR), GRADIENT),
        ((SURFACE, NEAR), GRADIENT),
        ((OFF_SURFACE,), VALUE),
        ((NEAR,), TANGENT),
    ]


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
@pytest.mark.parametrize("factor", [1.0, 0.3, 2.0])
def test_closed_forms_of_first_order_terms(shape, factor):
    points, _ = draw()
    field, f = Scaled(shape, factor), shape(points)
    near(residuals(DIRICHLET, field, points), factor * f.abs())
    near(residuals(OFF_SURFACE_TERM, field, points), torch.exp(-100 * factor * f.abs()))
    near(residuals(EIKONAL, field, points), torch.full_like(f, (factor**2 - 1) ** 2))
    near(residuals(EIKONAL_ABSOLUTE, field, points), torch.full_like(f, abs(factor - 1)))


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_off_diagonal_weingarten_is_half_the_difference_of_curvatures_times_the_sine(shape):
    """In a frame at φ from the principal one |S₁₂| = ½ |κ₁ − κ₂| |sin 2φ|: two 45° apart give κ₁ − κ₂."""
    points, angles = draw()
    one = residuals(OFF_DIAGONAL_WEINGARTEN, Scaled(shape), points, angles)
    other = residuals(OFF_DIAGONAL_WEINGARTEN, Scaled(shape), points, angles + math.pi / 4)
    near(2 * torch.hypot(one, other), principal(shape, points).abs())


@pytest.mark.parametrize("name", ["plane", "sphere"])
def test_off_diagonal_weingarten_is_zero_on_planes_and_spheres(name):
    assert residuals(OFF_DIAGONAL_WEINGARTEN, Scaled(SHAPES[name]), *draw()).max() < 1e-12


@pytest.mark.parametrize("radius", [0.05, 0.4, 3.0])
def test_mean_over_frames_on_a_cylinder(radius):
    shape = Cylinder(CENTRE, AXIS, radius)
    points, _ = draw(1, 3)
    at = points.clone().requires_grad_(True)
    (normal,) = torch.autograd.grad(shape(at).sum(), at)
    on_surface = (points - shape(points)[:, None] * normal).expand(4096, 3)
    angles = (torch.arange(4096, dtype=torch.float64) + 0.5) * 2 * math.pi / 4096
    mean = residuals(OFF_DIAGONAL_WEINGARTEN, Scaled(shape), on_surface, angles).mean()
    assert float(mean) == pytest.approx(1 / (math.pi * radius), rel=1e-6)


@given(seed=st.integers(0, 10_000), name=st.sampled_from(sorted(SHAPES)))
@settings(max_examples=20, deadline=None)
def test_the_mean_over_frames_does_not_turn_with_the_part(seed, name):
    generator = torch.Generator().manual_seed(seed)
    rotation = torch.linalg.qr(torch.randn(3, 3, dtype=torch.float64, generator=generator))[0]
    points, _ = draw(20, seed)
    means = []
    for field, at in (
        (Scaled(SHAPES[name]), points),
        (Scaled(SHAPES[name], 1.0, rotation), points @ rotation.T),
    ):
        turns = (torch.arange(4, dtype=torch.float64) * math.pi / 4).repeat_interleave(20)
        found = residuals(OFF_DIAGONAL_WEINGARTEN, field, at.repeat(4, 1), turns)
        means.append(found.view(4, 20).square().mean(0))
    near(means[1], means[0])


@pytest.mark.parametrize("factor", [1e-3, 0.5, -2.0, 1e3])
def test_a_multiple_of_the_field_has_the_same_weingarten_map(factor):
    points, angles = draw()
    angles = torch.zeros_like(angles)
    expected = residuals(OFF_DIAGONAL_WEINGARTEN, Scaled(SHAPES["torus"]), points, angles)
    found = residuals(OFF_DIAGONAL_WEINGARTEN, Scaled(SHAPES["torus"], abs(factor)), points, angles)
    near(found, expected)
    turned = residuals(OFF_DIAGONAL_WEINGARTEN, Scaled(SHAPES["torus"], factor), points, angles + math.pi / 4)
    again = residuals(OFF_DIAGONAL_WEINGARTEN, Scaled(SHAPES["torus"], factor), points, angles)
    near(2 * torch.hypot(turned, again), principal(SHAPES["torus"], points).abs(), 1e-8)


def test_free_space_is_the_distance_from_what_is_known():
    points, _ = draw()
    shape = SHAPES["sphere"]
    distance = torch.linspace(-1, 1, len(points), dtype=torch.float64)
    near(residuals(FREE_SPACE, Scaled(shape), points, None, distance), (shape(points) - distance).abs())


def test_free_space_is_silent_where_nothing_is_known():
    points, _ = draw()
    field = Scaled(SHAPES["sphere"])
    some = torch.linspace(-1, 1, len(points), dtype=torch.float64)
    some[::2] = float("nan")
    for distance, silent in ((None, slice(None)), (some, slice(0, None, 2))):
        field.factor.grad = None
        found = FREE_SPACE.residual(Autodiff(field)(points, VALUE), Sample(points, distance))[silent]
        assert (found == 0).all()
        found.sum().backward()
        assert field.factor.grad == 0


def test_critical_points_give_finite_residuals_and_gradients():
    """A constant field has no normal anywhere."""

    class Constant(torch.nn.Module):
        def __init__(self):
            super().__init__()
            self.level = torch.nn.Parameter(torch.tensor(0.3, dtype=torch.float64))

        def forward(self, points):
            return self.level + 0.0 * self.level * points.square().sum(-1)

    field, (points, angles) = Constant(), draw(10)
    for term in TERMS:
        found = term.residual(Autodiff(field)(points, term.order, angles), Sample(points))
        assert found.isfinite().all()
        found.sum().backward()
        assert field.level.grad.isfinite()


@pytest.mark.parametrize("term", TERMS, ids=[f"{term.name}-{i}" for i, term in enumerate(TERMS)])
def test_residuals_are_one_for_each_point_in_any_float_type(term):
    for dtype in (torch.float32, torch.float64):
        points = torch.rand(9, 3, dtype=dtype)
        field = Scaled(SHAPES["torus"]).to(dtype)
        field.rotation = field.rotation.to(dtype)
        found = residuals(term, field, points, torch.zeros(9, dtype=dtype))
        assert found.shape == (9,)
        assert found.dtype == dtype

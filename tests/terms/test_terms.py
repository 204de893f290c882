"""Every term on exact fields in float64 against its closed form, and what it must not depend on."""

import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.calculus.analytic import Analytic
from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.exact import Cone, Cylinder, Plane, Sphere, Torus
from weingarten.calculus.finite_difference import CROSS, DIAGONAL, FiniteDifference
from weingarten.calculus.jet import GRADIENT, HESSIAN, TANGENT, VALUE, tangent_frame
from weingarten.fields.siren import Siren
from weingarten.scan.sample import NEAR, OFF_SURFACE, SURFACE, Sample
from weingarten.terms.curriculum import CURRICULUM_FREE_SPACE, CURRICULUM_SURFACE
from weingarten.terms.dirichlet import DIRICHLET
from weingarten.terms.divergence import DIVERGENCE, DIVERGENCE_CLAMPED
from weingarten.terms.eikonal import EIKONAL, EIKONAL_ABSOLUTE, EIKONAL_OF_NORM
from weingarten.terms.free_space import FREE_SPACE
from weingarten.terms.gaussian_curvature import DOUBLE_TROUGH, GAUSSIAN_CURVATURE
from weingarten.terms.normal_divergence import NORMAL_DIVERGENCE
from weingarten.terms.normals import NORMALS
from weingarten.terms.off_diagonal_weingarten import FRAME_FREE_WEINGARTEN, OFF_DIAGONAL_WEINGARTEN
from weingarten.terms.off_surface import OFF_SURFACE_TERM
from weingarten.terms.principal_curvature import SMALLER_CURVATURE
from weingarten.terms.sign_agnostic import SIGN_AGNOSTIC
from weingarten.terms.singular_hessian import SINGULAR_HESSIAN

CENTRE, AXIS = (0.1, -0.2, 0.05), (1.0, 2.0, -2.0)
SHAPES = {
    "plane": Plane(CENTRE, AXIS),
    "sphere": Sphere(CENTRE, 0.6),
    "cylinder": Cylinder(CENTRE, AXIS, 0.4),
    "cone": Cone((0.0, 0.0, -3.0), (0.0, 0.0, 1.0), 0.3),
    "torus": Torus(CENTRE, AXIS, 0.6, 0.2),
}
CURVATURE_TERMS = (
    OFF_DIAGONAL_WEINGARTEN,
    FRAME_FREE_WEINGARTEN,
    SMALLER_CURVATURE,
    GAUSSIAN_CURVATURE,
    DOUBLE_TROUGH,
    SINGULAR_HESSIAN,
    DIVERGENCE,
    DIVERGENCE_CLAMPED,
    NORMAL_DIVERGENCE,
)
FIRST_ORDER = (DIRICHLET, OFF_SURFACE_TERM, EIKONAL, EIKONAL_ABSOLUTE, EIKONAL_OF_NORM, FREE_SPACE, NORMALS)
TERMS = (*FIRST_ORDER, *CURVATURE_TERMS)
NAMES = [term.residual.__module__.rpartition(".")[2] + "." + term.residual.__name__ for term in TERMS]
CURVATURE_NAMES = NAMES[-len(CURVATURE_TERMS) :]


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


class Bent(torch.nn.Module):
    """φ(f) = f + b sin f of an exact distance f: level sets as they were, but no distance."""

    def __init__(self, shape, bend=0.3):
        super().__init__()
        self.shape, self.bend = shape, bend

    def forward(self, points):
        f = self.shape(points)
        return f + self.bend * torch.sin(f)

    def slopes(self, points):
        """φ', φ''."""
        f = self.shape(points)
        return 1 + self.bend * torch.cos(f), -self.bend * torch.sin(f)


def principal(shape, points):
    """κ₁ − κ₂ of the level sets of an exact distance."""
    level = curvatures(shape, points)
    return level[:, 0] - level[:, 1]


def curvatures(shape, points):
    """κ₁ ≥ κ₂ of the level sets of an exact distance: k/(1 + k f) at the foot's curvatures k."""
    at = points.clone().requires_grad_(True)
    f = shape(at)
    (g,) = torch.autograd.grad(f.sum(), at)
    feet = shape.curvatures(at.detach() - f.detach()[:, None] * g)
    return feet / (1 + feet * f.detach()[:, None])


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
@pytest.mark.parametrize("factor", [1.0, 0.3, -2.0])
def test_normals_lose_their_length_times_one_minus_the_cosine(shape, factor):
    """Whatever the factor's size: 0 for the gradient's own direction, 2‖m‖ against it, ‖m‖ across."""
    points, angles = draw()
    at = points.clone().requires_grad_(True)
    (n,) = torch.autograd.grad(shape(at).sum(), at)
    u, _ = tangent_frame(n, angles)
    trust = torch.linspace(0.1, 1.0, len(points), dtype=torch.float64)
    jet = Autodiff(Scaled(shape, factor))(points, NORMALS.order, None)
    for normals, expected in ((n, 1.0 - math.copysign(1.0, factor)), (u, 1.0)):
        found = NORMALS.residual(jet, Sample(points, normals=trust[:, None] * normals))
        near(found.detach(), expected * trust)


def test_where_and_how_far_each_term_looks():
    """Method §2's table."""
    assert [(term.domains, term.order) for term in TERMS] == [
        ((SURFACE,), VALUE),
        ((OFF_SURFACE,), VALUE),
        ((SURFACE, NEAR), GRADIENT),
        ((SURFACE, NEAR), GRADIENT),
        ((OFF_SURFACE, NEAR), GRADIENT),
        ((OFF_SURFACE,), VALUE),
        ((SURFACE,), GRADIENT),
        *[((NEAR,), TANGENT)] * 5,
        ((NEAR,), HESSIAN),
        *[((OFF_SURFACE,), HESSIAN)] * 3,
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
    near(residuals(EIKONAL_OF_NORM, field, points), torch.full_like(f, (factor - 1) ** 2))


@pytest.mark.parametrize("factor", [1.0, 0.3, -2.0])
@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_closed_forms_of_curvature_terms(shape, factor):
    """Of c f: a level set's curvatures do not change but in sign; Laplacian and determinant do."""
    points, angles = draw()
    field = Scaled(shape, factor)
    first, second = curvatures(shape, points).t()
    gaussian = (first * second).abs()
    near(residuals(FRAME_FREE_WEINGARTEN, field, points, angles), (first - second).abs() / math.pi)
    near(residuals(SMALLER_CURVATURE, field, points, angles), torch.minimum(first.abs(), second.abs()))
    near(residuals(GAUSSIAN_CURVATURE, field, points, angles), gaussian)
    near(residuals(DOUBLE_TROUGH, field, points, angles), trough(gaussian))
    near(residuals(DIVERGENCE, field, points, angles), abs(factor) * (first + second).abs())
    near(residuals(SINGULAR_HESSIAN, field, points, angles), torch.zeros_like(first))
    near(residuals(NORMAL_DIVERGENCE, field, points, angles), torch.zeros_like(first))


def trough(curvature):
    """NeurCADRecon's polynomial as it is written, term by term; beyond its second trough a line."""
    pi = math.pi
    polynomial = (
        (64 * pi - 80) / pi**4 * curvature**4
        - (64 * pi - 88) / pi**3 * curvature**3
        + (16 * pi - 29) / pi**2 * curvature**2
        + 3 / pi * curvature
    )
    return torch.where(curvature < pi / 2, polynomial, 0.25 + curvature - pi / 2)


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_closed_forms_on_what_is_no_distance(shape):
    """Of φ(f): H = φ' H_f + φ'' ∇f ∇fᵀ, so that its normal part and its determinant do not vanish."""
    points, angles = draw()
    field = Bent(shape)
    slope, bend = field.slopes(points)
    first, second = curvatures(shape, points).t()
    near(residuals(NORMAL_DIVERGENCE, field, points, angles), bend.abs())
    near(residuals(SINGULAR_HESSIAN, field, points, angles), (slope**2 * first * second * bend).abs())
    near(residuals(DIVERGENCE, field, points, angles), (slope * (first + second) + bend).abs())
    near(residuals(GAUSSIAN_CURVATURE, field, points, angles), (first * second).abs())
    near(residuals(FRAME_FREE_WEINGARTEN, field, points, angles), (first - second).abs() / math.pi)


ZERO = {
    "off_diagonal_weingarten": {"plane", "sphere"},
    "frame_free_weingarten": {"plane", "sphere"},
    "smaller_curvature": {"plane", "cylinder", "cone"},
    "gaussian_curvature": {"plane", "cylinder", "cone"},
    "double_trough": {"plane", "cylinder", "cone"},
    "singular_hessian": {"plane", "sphere", "cylinder", "cone", "torus"},
    "divergence": {"plane"},
    "normal_divergence": {"plane", "sphere", "cylinder", "cone", "torus"},
}
"""Method §3's table."""


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("term", [t for t in CURVATURE_TERMS if t is not DIVERGENCE_CLAMPED], ids=ZERO)
def test_zero_sets(term, name):
    found = residuals(term, Scaled(SHAPES[name]), *draw())
    assert (float(found.max()) < 1e-9) == (name in ZERO[term.name])


def test_the_double_trough_falls_again_beyond_its_crest():
    at = torch.linspace(0, 2.5, 2501, dtype=torch.float64)
    values = trough(at)
    crest, dip = float(at[values[:1200].argmax()]), float(at[1000 + values[1000:2000].argmin()])
    assert 0.5 < crest < 0.9
    assert dip == pytest.approx(math.pi / 2, abs=0.05)
    assert trough(torch.tensor(dip)) < 0.4 * trough(torch.tensor(crest))


def test_the_double_trough_does_not_drown_the_rest_where_a_network_is_wild():
    """Untrained, |K| is 100 and more: its fourth power would be 10⁸ and more."""
    field = Siren(32, 3, generator=torch.Generator().manual_seed(0)).double()
    points, angles = draw()
    found = residuals(DOUBLE_TROUGH, field, points, angles)
    gaussian = residuals(GAUSSIAN_CURVATURE, field, points, angles)
    assert gaussian.median() > 10
    assert (found - gaussian).abs().max() < 1.5


def test_the_clamped_divergence_leaves_the_wild_alone():
    points, angles = draw()
    for factor, expected in ((1e4, 50.0), (0.0, 0.1)):
        found = residuals(DIVERGENCE_CLAMPED, Scaled(SHAPES["sphere"], factor), points, angles)
        assert (found == expected).all()


@pytest.mark.parametrize("stencil", [DIAGONAL, CROSS], ids=["diagonal", "cross"])
@pytest.mark.parametrize("term", CURVATURE_TERMS, ids=CURVATURE_NAMES)
def test_finite_differences_come_to_the_same_in_the_second_order(term, stencil):
    points, angles = draw()
    field = Bent(Torus((0.0, 0.0, 3.0), AXIS, 1.0, 0.25))

    def error(h):
        jet = FiniteDifference(Autodiff(field), h, stencil)(points, term.order, angles)
        found = term.residual(jet, Sample(points)).detach()
        return float((found - residuals(term, field, points, angles)).abs().mean())

    coarse, fine = error(0.02), error(0.005)
    assert fine < 1e-3
    assert coarse == pytest.approx(16 * fine, rel=0.2)


@pytest.mark.parametrize("term", CURVATURE_TERMS, ids=CURVATURE_NAMES)
def test_gradients_of_a_network_are_those_of_difference_quotients(term):
    """∂ mean residual / ∂ weights along random directions, through jets worked out by hand, frames held."""
    generator = torch.Generator().manual_seed(0)
    field = Siren(8, 3, 3.0, generator).double()
    points, angles = draw(20)
    weights = list(field.parameters())

    def mean():
        return term.residual(Analytic(field)(points, term.order, angles), Sample(points)).mean()

    found = torch.autograd.grad(mean(), weights, allow_unused=True, materialize_grads=True)
    expected = torch.autograd.grad(
        term.residual(Autodiff(field)(points, term.order, angles), Sample(points)).mean(),
        weights,
        allow_unused=True,
        materialize_grads=True,
    )
    for one, other in zip(found, expected, strict=True):
        near(one, other)
    # frames turn with the weights, and are held for the optimiser: only what no frame enters has a quotient
    if term in (SINGULAR_HESSIAN, DIVERGENCE, DIVERGENCE_CLAMPED):
        directions = [torch.randn(w.shape, dtype=w.dtype, generator=generator) for w in weights]
        slope = sum((g * d).sum() for g, d in zip(found, directions, strict=True))
        values = []
        for sign in (1.0, -1.0):
            with torch.no_grad():
                for weight, direction in zip(weights, directions, strict=True):
                    weight += sign * 1e-6 * direction
                values.append(float(mean()))
                for weight, direction in zip(weights, directions, strict=True):
                    weight -= sign * 1e-6 * direction
        assert float(slope) == pytest.approx((values[0] - values[1]) / 2e-6, rel=1e-5)


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


class Softplus(torch.nn.Module):
    """Somebody else's network."""

    def __init__(self):
        super().__init__()
        generator = torch.Generator().manual_seed(0)
        self.first = torch.nn.Parameter(torch.randn(16, 3, generator=generator))
        self.second = torch.nn.Parameter(0.1 * torch.randn(16, generator=generator))

    def forward(self, points):
        return torch.nn.functional.softplus(points @ self.first.t()) @ self.second


@pytest.mark.parametrize("term", TERMS, ids=NAMES)
@pytest.mark.parametrize("make", [Softplus, lambda: Siren(16, 3)], ids=["theirs", "ours"])
def test_a_term_alone_lowers_itself_in_any_training_loop(term, make):
    model, points = make(), draw(100)[0].float()
    radius = points.norm(dim=-1, keepdim=True)
    told = {FREE_SPACE: {"distance": radius[:, 0] - 0.5}, NORMALS: {"normals": points / radius}}
    known = told.get(term, {})
    optimiser = torch.optim.Adam(model.parameters(), lr=1e-4)
    angles = torch.zeros(100)
    before = term(model, points, angles, **known).mean().item()
    for _ in range(30):
        optimiser.zero_grad()
        loss = term(model, points, angles, **known)
        assert loss.shape == (100,)
        loss.mean().backward()
        optimiser.step()
    after = term(model, points, angles, **known).mean().item()
    # the divergence of a network that is wild, or tame, everywhere is all beyond the clamp
    assert after < before or (term is DIVERGENCE_CLAMPED and after == before)


def test_a_term_alone_draws_its_frames_and_takes_a_calculus():
    model, points = Siren(16, 3), draw(50)[0].float()
    torch.manual_seed(0)
    one, other = (OFF_DIAGONAL_WEINGARTEN(model, points) for _ in range(2))
    assert not torch.equal(one, other)
    angles = torch.zeros(50)
    expected = residuals(OFF_DIAGONAL_WEINGARTEN, model, points, angles)
    near(OFF_DIAGONAL_WEINGARTEN(Analytic(model), points, angles).detach(), expected, 1e-3)
    near(OFF_DIAGONAL_WEINGARTEN(model, points, angles).detach(), expected, 1e-3)


@given(seed=st.integers(0, 10_000), term=st.sampled_from(CURVATURE_TERMS[1:]))
@settings(max_examples=30, deadline=None)
def test_what_needs_no_frame_does_not_turn_with_the_part_nor_with_the_frame(seed, term):
    generator = torch.Generator().manual_seed(seed)
    rotation = torch.linalg.qr(torch.randn(3, 3, dtype=torch.float64, generator=generator))[0]
    points, angles = draw(20, seed)
    expected = residuals(term, Bent(SHAPES["torus"]), points, torch.zeros_like(angles))
    turned = Bent(Scaled(SHAPES["torus"], 1.0, rotation))
    near(residuals(term, turned, points @ rotation.T, angles), expected, 1e-8)


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


def test_sign_agnostic_regression_asks_for_the_distance_of_either_sign():
    points, _ = draw()
    shape, distance = SHAPES["sphere"], torch.linspace(0, 1, 200, dtype=torch.float64)
    expected = (shape(points).abs() - distance).abs()
    for factor in (1.0, -1.0):
        near(SIGN_AGNOSTIC(Scaled(shape, factor), points, unsigned=distance).detach(), expected)
    with pytest.raises(ValueError, match="distance to the cloud"):
        SIGN_AGNOSTIC(Scaled(shape), points)


@pytest.mark.parametrize(
    ("t", "tolerance", "hardness"),
    [
        (0.0, 0.025, 0.0),
        (0.1, 0.01, 0.1),
        (0.299, 0.01, 0.1),
        (0.3, 0.0025, 0.2),
        (0.5, 0.0, 0.5),
        (1.0, 0.0, 0.5),
    ],
)
def test_the_curriculum_against_its_formula_point_by_point(t, tolerance, hardness):
    points, _ = draw()
    shape, distance = SHAPES["sphere"], torch.linspace(-0.5, 0.5, 200, dtype=torch.float64)
    distance[::7] = float("nan")
    sample = Sample(points, distance, progress=t)
    jet = Autodiff(Scaled(shape))(points, VALUE)
    found = CURRICULUM_FREE_SPACE.residual(jet, sample)
    for own, y, f in zip(found.tolist(), distance.tolist(), shape(points).tolist(), strict=True):
        sign = math.copysign(1, y) * math.copysign(1, y - f)
        expected = 0.0 if math.isnan(y) else (1 + hardness * sign) * max(abs(y - f) - tolerance, 0.0)
        assert own == pytest.approx(expected, abs=1e-12)
    near(CURRICULUM_SURFACE.residual(jet, sample).detach(), (shape(points).abs() - tolerance).clamp_min(0))


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


@pytest.mark.parametrize("term", TERMS, ids=NAMES)
def test_residuals_are_one_for_each_point_in_any_float_type(term):
    for dtype in (torch.float32, torch.float64):
        points = torch.rand(9, 3, dtype=dtype)
        field = Scaled(SHAPES["torus"]).to(dtype)
        field.rotation = field.rotation.to(dtype)
        found = residuals(term, field, points, torch.zeros(9, dtype=dtype))
        assert found.shape == (9,)
        assert found.dtype == dtype


@pytest.mark.parametrize("term", [SINGULAR_HESSIAN, DIVERGENCE, DIVERGENCE_CLAMPED, NORMAL_DIVERGENCE])
def test_terms_of_all_of_the_hessian_do_not_take_a_tangent_block_for_it(term):
    points, angles = draw(5)
    jet = Autodiff(Scaled(SHAPES["torus"]))(points, TANGENT, angles)
    with pytest.raises(ValueError, match="order HESSIAN"):
        term.residual(jet, Sample(points))


class Bowl(torch.nn.Module):
    """f = x² + 2 y² − 3 z² + offset: a critical point at the origin, where the frame is any."""

    def __init__(self, offset):
        super().__init__()
        self.bend = torch.nn.Parameter(torch.tensor([1.0, 2.0, -3.0]))
        self.offset = offset

    def forward(self, points):
        return points.square() @ self.bend + self.offset


@pytest.mark.parametrize("term", TERMS, ids=NAMES)
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_a_critical_point_gives_a_finite_residual_and_a_finite_gradient(term, offset):
    field, points = Bowl(offset), torch.zeros(4, 3)
    jet = Autodiff(field)(points, term.order, torch.arange(4.0))
    found = term.residual(jet, Sample(points, torch.full((4,), 0.1)))
    assert found.isfinite().all()
    if found.requires_grad:
        found.mean().backward()
        assert field.bend.grad is None or field.bend.grad.isfinite().all()

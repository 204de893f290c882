"""The six-point stencil: exact to second order in h, and as far off at the authors' h as method §3 says."""

import pytest
import torch

from weingarten.calculus.analytic import Analytic
from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.exact import Cone, Cylinder, Plane, Sphere, Torus
from weingarten.calculus.finite_difference import CROSS, DIAGONAL, FiniteDifference
from weingarten.calculus.jet import GRADIENT, HESSIAN, TANGENT, VALUE
from weingarten.fields.siren import Siren

AXIS = (1.0, 2.0, -2.0)


class Module(torch.nn.Module):
    """An exact field as a torch module."""

    def __init__(self, shape):
        super().__init__()
        self.shape = shape

    def forward(self, points):
        return self.shape(points)


class Counting:
    """A calculus that writes down what it is asked for."""

    def __init__(self, inner):
        self.inner = inner
        self.calls = []

    def __call__(self, points, order, angles=None):
        self.calls.append((len(points), order))
        return self.inner(points, order, angles)


def draw(count=300, seed=0, dtype=torch.float64):
    generator = torch.Generator().manual_seed(seed)
    points = 2 * torch.rand(count, 3, dtype=dtype, generator=generator) - 1
    return points, 6.3 * torch.rand(count, dtype=dtype, generator=generator)


def error(inner, h, points, angles, order=TANGENT, stencil=DIAGONAL):
    """Sum of the errors of the second derivatives, relative to the sum of the exact values."""
    exact = inner(points, order, angles)
    found = FiniteDifference(inner, h, stencil)(points, order, angles)
    pairs = list(zip(exact.tensors[2:], found.tensors[2:], strict=True))
    return float((sum((b - a).abs().sum() for a, b in pairs) / sum(a.abs().sum() for a, _ in pairs)).detach())


FIELDS = {
    "siren": Siren(32, 4, 3.0, torch.Generator().manual_seed(0)).double(),
    "sphere": Module(Sphere((0.0, 0.0, 3.0), 1.0)),
    "cylinder": Module(Cylinder((3.0, 0.0, 0.0), AXIS, 1.0)),
    "cone": Module(Cone((-4.0, -4.0, 4.0), AXIS, 0.3)),
    "torus": Module(Torus((0.0, 0.0, 3.0), AXIS, 1.0, 0.25)),
}


@pytest.mark.parametrize("stencil", [DIAGONAL, CROSS], ids=["diagonal", "cross"])
@pytest.mark.parametrize("order", [TANGENT, HESSIAN])
@pytest.mark.parametrize("name", FIELDS)
def test_the_error_falls_as_the_square_of_h(name, order, stencil):
    points, angles = draw()
    inner = Autodiff(FIELDS[name])
    coarse, fine = (error(inner, h, points, angles, order, stencil) for h in (0.02, 0.005))
    slope = torch.log(torch.tensor(coarse / fine)) / torch.log(torch.tensor(4.0))
    assert float(slope) == pytest.approx(2.0, abs=0.05)
    assert fine < 1e-3


def test_a_quadratic_is_exact():
    """½ xᵀ A x has no fourth derivatives: nothing is left of the error but rounding."""

    class Quadratic(torch.nn.Module):
        def forward(self, points):
            a = points.new_tensor([[2.0, 0.5, 0.1], [0.5, -1.0, 0.3], [0.1, 0.3, 0.7]])
            return 0.5 * (points @ a * points).sum(-1) + points @ points.new_tensor([1.0, 2.0, -1.0])

    for stencil in (DIAGONAL, CROSS):
        assert error(Autodiff(Quadratic()), 0.05, *draw(), HESSIAN, stencil) < 1e-11


def test_a_plane_has_no_curvature():
    points, angles = draw()
    jet = FiniteDifference(Autodiff(Module(Plane(normal=AXIS))))(points, TANGENT, angles)
    assert max(float(x.detach().abs().max()) for x in (jet.uu, jet.uv, jet.vv)) < 1e-11


@pytest.mark.parametrize(("h", "mean_error", "loss_ratio"), [(0.05, 0.54, 0.69), (0.01, 0.034, 0.978)])
def test_how_far_off_the_authors_step_is_on_an_untrained_siren(h, mean_error, loss_ratio):
    """The mean error of |uᵀHv|, and its mean, to the exact mean (method §3: 40 % and 3 % off)."""
    field = Siren(generator=torch.Generator().manual_seed(0)).double()
    points, angles = draw(2000)
    with torch.no_grad():
        exact = Analytic(field)(points, TANGENT, angles).uv
        found = FiniteDifference(Analytic(field), h)(points, TANGENT, angles).uv
    assert float((found - exact).abs().mean() / exact.abs().mean()) == pytest.approx(mean_error, rel=0.15)
    assert float(found.abs().mean() / exact.abs().mean()) == pytest.approx(loss_ratio, abs=0.05)


@pytest.mark.parametrize(
    ("stencil", "order", "evaluations"),
    [(DIAGONAL, TANGENT, 6), (CROSS, TANGENT, 8), (DIAGONAL, HESSIAN, 12), (CROSS, HESSIAN, 18)],
)
def test_evaluations_beside_the_gradient(stencil, order, evaluations):
    counting = Counting(Autodiff(FIELDS["siren"]))
    points, angles = draw(10)
    FiniteDifference(counting, stencil=stencil)(points, order, angles)
    assert counting.calls == [(10, GRADIENT), (10 * evaluations, VALUE)]


@pytest.mark.parametrize("order", [VALUE, GRADIENT])
def test_lower_orders_are_the_inner_calculus(order):
    inner, (points, angles) = Autodiff(FIELDS["siren"]), draw(10)
    found, expected = FiniteDifference(inner)(points, order, angles), inner(points, order)
    assert torch.equal(found.value, expected.value)
    assert found.uv is None
    if order == GRADIENT:
        assert torch.equal(found.gradient, expected.gradient)


def test_weight_gradients_flow_through_the_stencil():
    """Analytic and autograd as inner calculus give the same loss gradient."""
    field, (points, angles) = Siren(16, 3, 5.0, torch.Generator().manual_seed(1)).double(), draw(20)
    grads = []
    for inner in (Analytic(field), Autodiff(field)):
        s12 = FiniteDifference(inner)(points, TANGENT, angles).shape_operator[1]
        grads.append(torch.autograd.grad(s12.abs().mean(), list(field.parameters())))
    scale = max(gradient.abs().max() for gradient in grads[1])
    for one, other in zip(*grads, strict=True):
        assert (one - other).abs().max() < 1e-9 * scale

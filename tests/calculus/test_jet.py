"""Tangent frames are orthonormal whatever the gradient, constants for the optimiser, and turn by angles."""

import math

import pytest
import torch

from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.exact import Sphere, Torus
from weingarten.calculus.jet import GRADIENT, HESSIAN, TANGENT, VALUE, Jet, tangent_frame, unit_normal

AXES = torch.cat([torch.eye(3), -torch.eye(3)]).double()
NEARLY_DOWN = torch.tensor([[1e-9, -1e-9, -1.0], [1e-5, 0.0, -1.0], [0.0, -0.0, -2e-3]]).double()


def gradients(generator):
    drawn = torch.randn(50, 3, dtype=torch.float64, generator=generator)
    return torch.cat([drawn, 1e-8 * drawn, 1e4 * drawn, AXES, NEARLY_DOWN])


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_frames_are_orthonormal_and_right_handed(generator, dtype):
    g = gradients(generator).to(dtype)
    angles = torch.rand(len(g), dtype=dtype, generator=generator) * 2 * math.pi
    u, v = tangent_frame(g, angles)
    normal = g / g.norm(dim=-1, keepdim=True)
    frame = torch.stack([u, v, normal], dim=-1)
    accuracy = 8 * torch.finfo(dtype).eps
    assert (frame.mT @ frame - torch.eye(3, dtype=dtype)).abs().max() < accuracy
    torch.testing.assert_close(torch.linalg.det(frame), torch.ones(len(g), dtype=dtype))


def test_angles_turn_u_towards_v(generator):
    g = gradients(generator)
    u, v = tangent_frame(g, torch.zeros(len(g), dtype=g.dtype))
    turned_u, turned_v = tangent_frame(g, torch.full((len(g),), 0.3, dtype=g.dtype))
    torch.testing.assert_close(turned_u, math.cos(0.3) * u + math.sin(0.3) * v)
    torch.testing.assert_close(turned_v, math.cos(0.3) * v - math.sin(0.3) * u)


def test_zero_gradient_gives_a_finite_frame():
    u, v = tangent_frame(torch.zeros(1, 3), torch.zeros(1))
    assert u.isfinite().all()
    assert v.isfinite().all()
    torch.testing.assert_close((u * v).sum(), torch.tensor(0.0))


def test_the_frame_is_detached(generator):
    g = gradients(generator).requires_grad_(True)
    u, v = tangent_frame(g, torch.ones(len(g), dtype=g.dtype, requires_grad=True))
    assert not u.requires_grad
    assert not v.requires_grad


def test_shape_operator_of_a_sphere_is_the_curvature_times_identity(generator):
    at = torch.randn(20, 3, dtype=torch.float64, generator=generator)
    jet = Autodiff(Module(Sphere(radius=0.5)))(
        at, TANGENT, torch.rand(20, dtype=torch.float64, generator=generator)
    )
    s11, s12, s22 = jet.shape_operator
    torch.testing.assert_close(s11, 1 / at.norm(dim=-1))
    torch.testing.assert_close(s22, 1 / at.norm(dim=-1))
    assert s12.abs().max() < 1e-14


def test_the_hessian_in_the_frame_is_that_of_the_axes(generator):
    """(u v n)ᵀ H (u v n) against H by autograd's jacobian, one point after another; of a torus Hn = 0."""
    shape = Torus((0.1, 0.0, 0.0), (1.0, 2.0, -2.0), 0.6, 0.2)

    def bent(points):
        return shape(points) + 0.3 * shape(points).square()

    at = 2 * torch.rand(20, 3, dtype=torch.float64, generator=generator) - 1
    angles = torch.rand(20, dtype=torch.float64, generator=generator)
    jet = Autodiff(Module(bent))(at, HESSIAN, angles)
    u, v = tangent_frame(jet.slope, angles)
    frame = torch.stack([u, v, unit_normal(jet.slope)], dim=-1)
    slow = torch.stack([torch.autograd.functional.hessian(lambda x: bent(x[None])[0], x) for x in at])
    torch.testing.assert_close(jet.hessian, frame.mT @ slow @ frame)
    normal = Autodiff(Module(shape))(at, HESSIAN, angles)
    assert torch.stack([normal.un, normal.vn, normal.nn]).abs().max() < 1e-9


@pytest.mark.parametrize("order", [VALUE, GRADIENT])
def test_a_jet_says_what_it_lacks(order):
    at = torch.ones(1, 3)
    jet = Autodiff(Module(Sphere()))(at, order)
    with pytest.raises(ValueError, match="order TANGENT"):
        _ = jet.shape_operator
    with pytest.raises(ValueError, match="order HESSIAN"):
        _ = jet.hessian
    if order == VALUE:
        with pytest.raises(ValueError, match="order GRADIENT"):
            _ = jet.slope


def test_a_linear_field_has_a_hessian_of_zero():
    """Its gradient is a constant, which autograd does not differentiate."""

    class Linear(torch.nn.Module):
        def forward(self, points):
            return points @ points.new_tensor([1.0, 2.0, -2.0])

    jet = Autodiff(Linear())(torch.rand(5, 3), HESSIAN)
    assert torch.equal(jet.hessian, torch.zeros(5, 3, 3))
    assert torch.equal(jet.slope, torch.tensor([1.0, 2.0, -2.0]).expand(5, 3))


def test_a_critical_point_has_a_finite_shape_operator():
    one = torch.ones(1)
    s11, _, _ = Jet(one, torch.zeros(1, 3), one, one, one).shape_operator
    assert s11.isfinite().all()


class Module(torch.nn.Module):
    """An exact field as a torch module."""

    def __init__(self, shape):
        super().__init__()
        self.shape = shape

    def forward(self, points):
        return self.shape(points)

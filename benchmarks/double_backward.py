"""The paper's loss as research codes write it: autograd.grad with create_graph, all points at once.

Second derivatives are either products Hv by one more autograd.grad (DoubleBackward) or the whole Hessian by
three more (FullHessian); the backward pass goes through all of them.
"""

import itertools

import torch
from torch import Tensor, nn

from weingarten.calculus.jet import tangent_frame


class Sine(nn.Module):
    """sin(30 x)."""

    def forward(self, x: Tensor) -> Tensor:
        """Elementwise."""
        return torch.sin(30.0 * x)


def network(width: int = 256, depth: int = 5) -> nn.Sequential:
    """A SIREN of ordinary layers, initialised as in Sitzmann et al. 2020."""
    sizes = [3, *[width] * depth]
    layers: list[nn.Module] = []
    for i, (fan_in, fan_out) in enumerate(itertools.pairwise(sizes)):
        linear = nn.Linear(fan_in, fan_out)
        bound = 1.0 / fan_in if i == 0 else (6.0 / fan_in) ** 0.5 / 30.0
        nn.init.uniform_(linear.weight, -bound, bound)
        layers += [linear, Sine()]
    head = nn.Linear(width, 1)
    bound = (6.0 / width) ** 0.5 / 30.0
    nn.init.uniform_(head.weight, -bound, bound)
    return nn.Sequential(*layers, head)


def gradient(values: Tensor, points: Tensor) -> Tensor:
    """∂ values / ∂ points, with a graph for the next derivative."""
    return torch.autograd.grad(values, points, torch.ones_like(values), create_graph=True)[0]


class DoubleBackward:
    """`step(surface, off_surface, near, angles, weight)` takes one step of Adam."""

    def __init__(self) -> None:
        self.field = network()
        self.optimiser = torch.optim.Adam(self.field.parameters(), lr=5e-5)

    def loss(
        self, surface: Tensor, off_surface: Tensor, near: Tensor, angles: Tensor, weight: float
    ) -> Tensor:
        """7000 DM + 600 DNM + 50 EIK + weight · ODW (design notes, §2)."""
        surface, near = surface.requires_grad_(True), near.requires_grad_(True)
        on, off, by = self.field(surface), self.field(off_surface), self.field(near)
        slope_on, slope_by = gradient(on, surface), gradient(by, near)
        u, v = tangent_frame(slope_by.detach(), angles)
        twist = self.mixed(slope_by, near, u, v) / slope_by.norm(dim=-1)
        slopes = torch.cat([slope_on, slope_by])
        eikonal = (slopes.square().sum(-1) - 1).square().mean()
        on_surface, off_surface_term = on.abs().mean(), torch.exp(-100 * off.abs()).mean()
        return 7000 * on_surface + 600 * off_surface_term + 50 * eikonal + weight * twist.abs().mean()

    def mixed(self, slope: Tensor, points: Tensor, u: Tensor, v: Tensor) -> Tensor:
        """uᵀHv at points with the gradient `slope`."""
        return (gradient((slope * v).sum(-1), points) * u).sum(-1)

    def step(
        self, surface: Tensor, off_surface: Tensor, near: Tensor, angles: Tensor, weight: float
    ) -> float:
        """One step; the loss before it."""
        self.optimiser.zero_grad()
        total = self.loss(surface, off_surface, near, angles, weight)
        total.backward()
        torch.nn.utils.clip_grad_norm_(self.field.parameters(), 10.0)
        self.optimiser.step()
        return float(total.detach())


class FullHessian(DoubleBackward):
    """The same step with the whole 3×3 Hessian, row by row."""

    def mixed(self, slope: Tensor, points: Tensor, u: Tensor, v: Tensor) -> Tensor:
        """uᵀHv at points with the gradient `slope`."""
        hessian = torch.stack([gradient(row, points) for row in slope.unbind(-1)], dim=1)
        return (u * (hessian * v.unsqueeze(1)).sum(-1)).sum(-1)

"""The paper's loss and loop, slow and obvious: plain autograd, double backward, torch's own Adam.

Written from design notes §1, 2 and 4 alone. Of the package it uses the draws and the frame's convention for
their angles only, so that it sees the same points and directions.
"""

import itertools

import torch
from torch import Tensor

from weingarten.calculus.jet import tangent_frame
from weingarten.scan.sample import NEAR, OFF_SURFACE, SURFACE

KNOTS = [(0.0, 10.0), (0.2, 10.0), (0.5, 0.001), (1.0, 0.0)]
RISING = [(0.0, 0.0), (0.2, 0.0), (0.5, 9.999), (1.0, 10.0)]


def field(parameters: list[Tensor], x: Tensor) -> Tensor:
    """SIREN: weights and biases in turn, sin(30 ·) between layers."""
    layers = list(zip(parameters[0::2], parameters[1::2], strict=True))
    for weight, bias in layers[:-1]:
        x = torch.sin(30.0 * (x @ weight.T + bias))
    weight, bias = layers[-1]
    return (x @ weight.T + bias)[:, 0]


def gradient(values: Tensor, x: Tensor) -> Tensor:
    """∂ values / ∂ x, differentiable again."""
    return torch.autograd.grad(values.sum(), x, create_graph=True)[0]


def schedule(name: str, t: float) -> float:
    """λ_ODW(t)."""
    if name in ("constant", "none"):
        return {"constant": 10.0, "none": 0.0}[name]
    knots = RISING if name == "increasing" else KNOTS
    for (start, weight), (end, target) in itertools.pairwise(knots):
        if start <= t < end:
            r = (t - start) / (end - start)
            if name in ("linear", "increasing"):
                return weight + (target - weight) * r
            if name == "quintic":
                return weight + (target - weight) * (1 - (1 - r) ** 5)
            return {"step": weight, "step-next": target}[name]
    return knots[-1][1]


def off_diagonal(parameters: list[Tensor], near: Tensor, angles: Tensor, h: float | None) -> Tensor:
    """mean |uᵀHv| / ‖∇f‖, exactly or by the six-point stencil at distance h."""
    x = near.clone().requires_grad_(True)
    f = field(parameters, x)
    g = gradient(f, x)
    u, v = tangent_frame(g.detach(), angles)
    if h is None:
        mixed = (gradient((g * v).sum(1), x) * u).sum(1)
    else:
        plus = field(parameters, near + h * (u + v)) - field(parameters, near + h * u)
        plus = (plus - field(parameters, near + h * v) + f) / h**2
        minus = field(parameters, near - h * (u + v)) - field(parameters, near - h * u)
        minus = (minus - field(parameters, near - h * v) + f) / h**2
        mixed = (plus + minus) / 2
    return (mixed.abs() / g.norm(dim=1)).mean()


def loss(
    parameters: list[Tensor],
    points: dict[str, Tensor],
    angles: Tensor,
    weight: float,
    h: float | None = None,
) -> Tensor:
    """7000 DM + 600 DNM + 50 EIK + λ ODW."""
    x = torch.cat([points[SURFACE], points[NEAR]]).requires_grad_(True)
    slopes = gradient(field(parameters, x), x)
    dirichlet = field(parameters, points[SURFACE]).abs().mean()
    off_surface = torch.exp(-100.0 * field(parameters, points[OFF_SURFACE]).abs()).mean()
    eikonal = ((slopes**2).sum(1) - 1.0).pow(2).mean()
    total = 7000.0 * dirichlet + 600.0 * off_surface + 50.0 * eikonal
    if weight > 0.0:
        total = total + weight * off_diagonal(parameters, points[NEAR], angles, h)
    return total


def curve(
    parameters: list[Tensor], draws, generator: torch.Generator, name: str, steps: int, count: int, h=None
) -> list[float]:
    """The loss before each of `steps` steps of Adam at 5e-5, gradients clipped to norm 10."""
    parameters = [weight.detach().clone().requires_grad_(True) for weight in parameters]
    optimiser = torch.optim.Adam(parameters, lr=5e-5)
    losses = []
    for step in range(steps):
        samples = draws(count, generator)
        points = {domain: sample.points for domain, sample in samples.items()}
        optimiser.zero_grad()
        total = loss(parameters, points, samples[NEAR].angles, schedule(name, step / steps), h)
        total.backward()
        torch.nn.utils.clip_grad_norm_(parameters, 10.0)
        optimiser.step()
        losses.append(float(total.detach()))
    return losses

"""A field as the extraction wants it: positions in, values or planes out, no graph kept."""

from collections.abc import Callable

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.choice import exact
from weingarten.calculus.jet import SMALLEST_NORM, TANGENT, VALUE, Jet
from weingarten.crew import Crew
from weingarten.surface.planes import Measure, Planes, Points
from weingarten.terms.principal_curvature import principal_curvatures

PIECE = 8192
"""Points that a core evaluates together: few enough that every core gets some."""

BATCH = 1 << 18
"""Points that another device evaluates together, and so the most that it pays to ask for at once."""


def field_values(module: nn.Module, crew: Crew) -> Callable[[Float[Tensor, "n 3"]], Float[Tensor, " n"]]:
    """The values of a network, wherever it lives, by its fastest calculus; a piece of the points a core."""
    calculus = exact(module)
    device = next(module.parameters()).device
    size = PIECE if device.type == "cpu" else BATCH

    def piece_values(points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        return calculus(points.to(device), VALUE).value

    def values(points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        with torch.no_grad(), crew:
            return torch.cat(crew.map(piece_values, points.split(size)))

    return values


def field_jets(module: nn.Module, crew: Crew) -> Callable[[Points, int], Jet]:
    """The jets of a network at positions, float32, on the CPU; tangent frames are not turned."""
    calculus = exact(module)
    device = next(module.parameters()).device
    size = PIECE if device.type == "cpu" else BATCH

    def jets(points: Points, order: int) -> Jet:
        def piece_jets(at: Float[Tensor, "n 3"]) -> tuple[Tensor, ...]:
            return calculus(at.to(device), order, at.new_zeros(len(at)).to(device)).tensors

        at = torch.from_numpy(points.astype(np.float32))
        with torch.no_grad(), crew:
            rows = crew.map(piece_jets, at.split(size))
        return Jet(*(torch.cat(column).detach().cpu() for column in zip(*rows, strict=True)))

    return jets


def field_planes(module: nn.Module, crew: Crew) -> Measure:
    """The planes of a network's zero set near points: one Newton step along the gradient."""
    calculus = exact(module)
    device = next(module.parameters()).device
    size = PIECE if device.type == "cpu" else BATCH

    def piece_planes(points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 5"]:
        jet = calculus(points.to(device), TANGENT, points.new_zeros(len(points)).to(device))
        bend = torch.stack(principal_curvatures(jet)).abs().amax(dim=0)
        return torch.cat([jet.value[:, None], jet.slope, bend[:, None]], dim=1).cpu()

    def planes(points: Points) -> Planes:
        at = torch.from_numpy(points.astype(np.float32))
        with torch.no_grad(), crew:
            rows = torch.cat(crew.map(piece_planes, at.split(size))).numpy().astype(np.float64)
        value, slope, bend = rows[:, :1], rows[:, 1:4], rows[:, 4]
        norm = np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), SMALLEST_NORM)
        return Planes(points - value / norm * (slope / norm), slope / norm, bend)

    return planes

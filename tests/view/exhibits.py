"""Exhibits whose every figure is known: a ball of radius 5 about (10, 0, −3), and a run of a few steps."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
import trimesh
from jaxtyping import Float64
from torch import nn

import weingarten as wg
from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.samples.parts import sample_part
from weingarten.view.exhibit import Exhibit
from weingarten.view.primitives import Primitives
from weingarten.view.section import Box
from weingarten.view.subject import Cloud, Look, Surface
from weingarten.world_field import WorldField

RADIUS, CENTRE = 5.0, np.array([10.0, 0.0, -3.0])
FRAME = Frame((10.0, 0.0, -3.0), 5.0)
OFF = 0.1
"""How far the points of the upper half are off the ball."""


class Ball(nn.Module):
    """The exact distance to the unit sphere."""

    def __init__(self) -> None:
        super().__init__()
        self.radius = nn.Parameter(torch.tensor(1.0))

    def forward(self, points: torch.Tensor) -> torch.Tensor:
        return points.norm(dim=-1) - self.radius


def mesh(fineness: int = 4) -> Mesh:
    sphere = trimesh.creation.icosphere(fineness)
    return Mesh(RADIUS * np.array(sphere.vertices) + CENTRE, np.array(sphere.faces, dtype=np.int64))


def points() -> Float64[np.ndarray, "n 3"]:
    """On the lower half of the ball, and OFF beyond the upper half."""
    directions = np.random.default_rng(0).normal(size=(20_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return (RADIUS + OFF * (directions[:, 2:] > 0)) * directions + CENTRE


@dataclass
class Known:
    """A subject that is told what it is."""

    name: str = 'ball <b>&"$x'
    cloud: Cloud | None = None
    box: Box | None = None
    primitives: Primitives | None = None
    frame: Frame = FRAME
    now: Look = field(default_factory=lambda: Look(final="1"))

    def look(self) -> Look:
        return self.now

    def surface(self, step: int | None) -> Surface:
        return Surface(mesh(), WorldField(Ball(), FRAME) if self.box else None, self.primitives)


def ball() -> Exhibit:
    """With points, a field, and two primitives: the upper half and the rest, of which none."""
    upper = np.where(mesh().vertices[:, 2] > CENTRE[2], 0, -1)
    box = Box(CENTRE - 1.2 * RADIUS, CENTRE + 1.2 * RADIUS)
    return Exhibit(
        Known(cloud=Cloud.of(points()), box=box, primitives=Primitives(upper, ("0 dome",))), 60_000
    )


def run(folder: Path, steps: int = 40) -> Path:
    """A run folder of the bundled flange after a few steps."""
    settings = wg.resolve(steps=steps, points=200, resolution=40)
    wg.reconstruct(sample_part("flange", 3000, 0), settings, run_folder=folder)
    return folder

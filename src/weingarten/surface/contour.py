"""The zero set of a field as a closed triangle mesh, made of the cells that the octree found.

The mesh is watertight whatever the field is: every edge has exactly two faces, the sides of the box close
what leaves it, and a node on which the field vanishes (|f| < 1e-6·h, h the cell's side) counts as outside
by that much, so faces that lie in the lattice's own planes make no holes.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float64, Int32
from torch import Tensor

from weingarten.crew import Crew
from weingarten.mesh import Mesh
from weingarten.surface.bounds import with_next
from weingarten.surface.bricks import SIDE, Bricks
from weingarten.surface.cases import CORNERS
from weingarten.surface.cells import Cells
from weingarten.surface.flood import CROSSING
from weingarten.surface.lattice import Lattice
from weingarten.surface.marching_cubes import marching_cubes
from weingarten.surface.octree import Octree, Values

BATCH = 8192
BLOCK = SIDE + 1
_TOUCHING = 1e-3

Mesher = Callable[[Cells], Mesh]


@dataclass(frozen=True)
class Extraction:
    """What an extraction gave and what it cost.

    mesh: in the unit frame.
    evaluations: points at which the field was evaluated.
    notes: sentences for the user, about what was done to the surface.
    """

    mesh: Mesh
    evaluations: int
    notes: tuple[str, ...] = ()


def extract(
    values: Values,
    lower: Float64[np.ndarray, " 3"],
    upper: Float64[np.ndarray, " 3"],
    resolution: int,
    batch: int = BATCH,
) -> Mesh:
    """The zero set of a field inside a box, watertight, wound so that normals point to positive values.

    values: the field, (n, 3) float32 positions in the unit frame → (n,); about a distance, of any scale.
    lower, upper: corners of the box, unit frame.
    resolution: cubic cells along the box's longest side.
    batch: points a call of the field; blocks of some thousand stay in the processor's cache.

    Raises ExtractionError where the field does not change sign in the box or is not finite, OptionError
    for an empty box or a resolution below 2.
    """
    return extraction(values, lower, upper, resolution, batch).mesh


def extraction(
    values: Values,
    lower: Float64[np.ndarray, " 3"],
    upper: Float64[np.ndarray, " 3"],
    resolution: int,
    batch: int = BATCH,
    crew: Crew | None = None,
    mesher: Mesher = marching_cubes,
) -> Extraction:
    """As extract, with the number of evaluations and notes.

    crew: who does the work on a CPU. mesher: makes the mesh of the cells.
    """
    crew = crew or Crew()
    lattice = Lattice.over(lower, upper, resolution)
    octree = Octree(values, lattice, batch, crew)
    octree.refine()
    mesh = mesher(_crossed(octree.bricks, lattice, crew, octree.piece))
    notes = ()
    if lattice.depths(lattice.places(mesh.vertices)).min() < _TOUCHING:
        notes = ("The surface leaves the extraction box and was closed at the box's sides.",)
    return Extraction(mesh, octree.evaluations, notes)


def _crossed(bricks: Bricks, lattice: Lattice, crew: Crew, piece: int) -> Cells:
    """The cells that have corners of both signs: all that leaves the field's device."""
    shifts = torch.from_numpy(CORNERS @ np.array([BLOCK**2, BLOCK, 1])).to(bricks.bounds.device)

    def crossed(slots: Int32[Tensor, " b"]) -> Int32[Tensor, "m 8"]:
        addresses = bricks.block(bricks.firsts(slots), BLOCK)
        sides = bricks.sides(addresses)
        for shift in (1, BLOCK, BLOCK**2):
            sides = with_next(torch.bitwise_or, sides, shift)
        own = (sides == CROSSING).view(-1, BLOCK, BLOCK, BLOCK)
        own[:, -1], own[:, :, -1], own[:, :, :, -1] = False, False, False
        return addresses[own.view(-1).nonzero() + shifts]

    with torch.no_grad(), crew:
        corners = torch.cat(crew.map(crossed, bricks.slots(piece)))
        number = torch.zeros(bricks.bounds.shape[1], dtype=torch.int32, device=corners.device)
        number[corners] = 1
        used = number.nonzero().squeeze(1).to(torch.int32)
        number[used] = torch.arange(len(used), dtype=torch.int32, device=corners.device)
        found = number[corners], bricks.nodes(used).T, bricks.bounds[0, used]
    corners, nodes, values = (part.cpu().numpy() for part in found)
    return Cells(corners, nodes, values, lattice)

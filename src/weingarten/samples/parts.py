"""Three machine parts that come with the package, as exact solids; all lengths in millimetres.

They stand away from the origin, as parts in a scanner's frame do. Their surfaces are known in closed form,
so a sample lies on them to rounding and any error of a reconstruction is the reconstruction's.
"""

import math
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Float64, Int64
from torch import Tensor

from weingarten.calculus.exact import (
    Box,
    CappedCylinder,
    Cone,
    Difference,
    Intersection,
    Plane,
    Shape,
    Torus,
    Union,
)
from weingarten.errors import OptionError
from weingarten.mesh import Mesh
from weingarten.samples.patches import Points, patches, primitives
from weingarten.scan.sampling import Seed, generator
from weingarten.surface.contour import Mesher, extraction
from weingarten.surface.marching_cubes import marching_cubes

UP = (0.0, 0.0, 1.0)
ON_SURFACE = 1e-10
BATCH = 16_384


@dataclass(frozen=True)
class Part:
    """A solid and a box that it fits in, centre and half sides, millimetres; genus as designed."""

    solid: Shape
    centre: tuple[float, float, float]
    half: tuple[float, float, float]
    genus: int
    description: str


def _upright(x: float, y: float, low: float, high: float, radius: float) -> CappedCylinder:
    return CappedCylinder((x, y, (low + high) / 2), UP, radius, (high - low) / 2)


def _flange() -> Part:
    """Disc Ø80 × 10, hub Ø40 to a height of 28, bore Ø22, six holes Ø8 on a circle Ø62."""
    x, y, z = 210.0, -95.0, 60.0
    turns = [2 * math.pi * k / 6 for k in range(6)]
    bolts = [_upright(x + 31 * math.cos(t), y + 31 * math.sin(t), z - 5, z + 20, 4.0) for t in turns]
    body = Union((_upright(x, y, z, z + 10, 40.0), _upright(x, y, z + 2, z + 28, 20.0)))
    solid = Difference(body, Union((_upright(x, y, z - 5, z + 40, 11.0), *bolts)))
    return Part(solid, (x, y, z + 14), (40.0, 40.0, 14.0), 7, "flange with hub, bore and six bolt holes")


def _bracket() -> Part:
    """Base 80 × 50 × 8, upright wall 8 × 50 × 60, a rib 6 thick between them, three holes."""
    x, y, z = -140.0, 75.0, 20.0
    base = Box((x + 40, y + 25, z + 4), (40.0, 25.0, 4.0))
    wall = Box((x + 4, y + 25, z + 30), (4.0, 25.0, 30.0))
    slope = Plane((x + 50, y + 25, z + 8), (1.0, 0.0, 1.0))
    rib = Intersection((Box((x + 30, y + 25, z + 29), (28.0, 3.0, 25.0)), slope))
    across = CappedCylinder((x + 4, y + 38, z + 46), (1.0, 0.0, 0.0), 5.0, 10.0)
    holes = (
        _upright(x + 66, y + 12, z - 5, z + 15, 5.0),
        _upright(x + 66, y + 38, z - 5, z + 15, 5.0),
        across,
    )
    solid = Difference(Union((base, wall, rib)), Union(holes))
    return Part(
        solid, (x + 40, y + 25, z + 30), (40.0, 25.0, 30.0), 3, "L-bracket with a rib and three holes"
    )


def _block() -> Part:
    """Plate 76 × 56 × 20, boss Ø40 to a height of 36 with its rim rounded by 4, bore Ø14 countersunk to Ø24,
    a groove of radius 2 round the boss, four holes Ø7."""
    x, y, z = 30.0, 160.0, -45.0
    plate = Box((x, y, z + 10), (38.0, 28.0, 10.0))
    rim = Torus((x, y, z + 32), UP, 16.0, 4.0)
    boss = Union((_upright(x, y, z + 5, z + 32, 20.0), _upright(x, y, z + 6, z + 36, 16.0), rim))
    groove = Torus((x, y, z + 20), UP, 24.0, 2.0)
    countersink = Cone((x, y, z + 24), UP, math.pi / 4)
    corners = [(x + 32 * a, y + 22 * b) for a in (-1, 1) for b in (-1, 1)]
    holes = [_upright(u, v, z - 5, z + 30, 3.5) for u, v in corners]
    tools = Union((_upright(x, y, z - 5, z + 40, 7.0), countersink, groove, *holes))
    return Part(
        Difference(Union((plate, boss)), tools),
        (x, y, z + 18),
        (38.0, 28.0, 18.0),
        5,
        "block with a rounded boss, a countersunk bore, a groove and four holes",
    )


PARTS = {"flange": _flange(), "bracket": _bracket(), "block": _block()}


def part(name: str) -> Part:
    """The part of that name. Raises OptionError for any other."""
    if name not in PARTS:
        raise OptionError(f"There is no bundled part named {name!r}; choose one of {', '.join(PARTS)}.")
    return PARTS[name]


def sample_part(name: str, count: int, seed: Seed) -> Points:
    """`sample_solid` of a bundled part, millimetres. Raises OptionError."""
    return sample_solid(part(name), count, seed)


def sample_solid(chosen: Part, count: int, seed: Seed) -> Points:
    """`count` points on the exact surface of a solid, uniform by area, in its own frame.

    Points uniform on the surfaces of all primitives are kept where the whole solid's field is zero as well;
    where two primitives share a face, only the first one's points are.
    """
    leaves = primitives(chosen.solid)
    centre, reach = np.asarray(chosen.centre), float(np.linalg.norm(chosen.half))
    pieces = [(index, patch) for index, leaf in enumerate(leaves) for patch in patches(leaf, centre, reach)]
    areas = np.array([patch.area for _, patch in pieces])
    random = generator(seed)
    kept, missing = [], count
    while missing > 0:
        numbers = random.multinomial(BATCH, areas / areas.sum()).tolist()
        points = np.concatenate(
            [patch.draw(random, n) for (_, patch), n in zip(pieces, numbers, strict=True)]
        )
        owner = np.repeat([index for index, _ in pieces], numbers)
        found = points[_exposed(chosen, leaves, points, owner, ON_SURFACE * reach)]
        kept.append(random.permutation(found)[:missing])
        missing -= len(kept[-1])
    return np.concatenate(kept) if kept else np.empty((0, 3))


def _exposed(
    chosen: Part, leaves: list[Shape], points: Points, owner: Int64[np.ndarray, " n"], tolerance: float
) -> Int64[np.ndarray, " m"]:
    """Indices of the points that lie on the part's surface, and on no primitive before their own."""
    distance = np.abs(points - np.asarray(chosen.centre)) - np.asarray(chosen.half)
    index = np.flatnonzero((distance <= tolerance).all(axis=1))
    index = index[(chosen.solid(torch.from_numpy(points[index])).abs() <= tolerance).numpy()]
    tensor = torch.from_numpy(points[index])
    first = np.ones(len(index), dtype=bool)
    for number, leaf in enumerate(leaves[:-1]):
        first &= (owner[index] <= number) | (leaf(tensor).abs() > tolerance).numpy()
    return index[first]


def part_mesh(name: str, resolution: int = 192) -> Mesh:
    """`solid_mesh` of a bundled part, millimetres. Raises OptionError."""
    return solid_mesh(part(name), resolution)


def solid_mesh(chosen: Part, resolution: int, mesher: Mesher = marching_cubes) -> Mesh:
    """A watertight mesh of a solid in its own frame: the contour of its exact field.

    resolution: cells along the longest side. Faces and bores are within a few thousandths of a cell. mesher:
    marching cubes cut sharp edges off by up to half a cell.
    """
    centre, scale = np.asarray(chosen.centre), max(chosen.half)

    def values(points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        world = points.double() * scale + torch.from_numpy(centre)
        return (chosen.solid(world) / scale).to(points.dtype)

    margin = 1.0 + 4.0 / resolution
    upper: Float64[np.ndarray, " 3"] = np.asarray(chosen.half) / scale * margin + 1e-3
    mesh = extraction(values, -upper, upper, resolution, mesher=mesher).mesh
    return Mesh(mesh.vertices * scale + centre, mesh.faces)

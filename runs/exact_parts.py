"""Ten parts of exact primitives, as true meshes with a scan beside each: what `weingarten bench` compares on.

    python runs/exact_parts.py OUT [--points 30000] [--seed 0]
    weingarten bench OUT --methods odw-oriented,odw,poisson --out compared

Each is hard in its own way, and all of them are known in closed form: the scans lie on the exact surfaces,
and the meshes have their vertices on them, on sharp edges and corners too. Written for every part: how far
samples of the mesh are from the exact surface, and the exact points from the mesh. The longest side is about
1. Run it with the Python of the environment that has weingarten.
"""

import argparse
import math
import sys
from pathlib import Path

import numpy as np
import torch

from weingarten.calculus.exact import (
    Box,
    CappedCylinder,
    Cone,
    Difference,
    Intersection,
    Plane,
    Shape,
    Sphere,
    Torus,
    Union,
)
from weingarten.io.cloud_file import write_cloud
from weingarten.io.mesh import write_mesh
from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest
from weingarten.metrics.topology import topology
from weingarten.samples.parts import Part, sample_solid, solid_mesh
from weingarten.samples.patches import Points
from weingarten.scan.sampling import sample_surface
from weingarten.surface.planes import Measure, Planes
from weingarten.surface.sharp_contour import SharpContour

Y, UP = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
RESOLUTION, SAMPLES = 400, 20_000


def upright(x: float, y: float, low: float, high: float, radius: float) -> CappedCylinder:
    """A cylinder along z."""
    return CappedCylinder((x, y, (low + high) / 2), UP, radius, (high - low) / 2)


def fins() -> Part:
    """A heat sink: nine fins 0.012 thick, 0.25 high, 0.05 apart."""
    base = Box((0.0, 0.0, 0.03), (0.3, 0.5, 0.03))
    blades = tuple(Box((0.06 * k, 0.0, 0.16), (0.006, 0.5, 0.15)) for k in range(-4, 5))
    return Part(Union((base, *blades)), (0.0, 0.0, 0.155), (0.3, 0.5, 0.155), 0, "thin fins")


def deep_holes() -> Part:
    """A block with four blind holes 12 diameters deep and one through it."""
    block = Box((0.0, 0.0, 0.0), (0.2, 0.2, 0.5))
    blind = [upright(0.1 * a, 0.1 * b, 0.02, 0.6, 0.02) for a in (-1, 1) for b in (-1, 1)]
    solid = Difference(block, Union((*blind, upright(0.0, 0.0, -0.6, 0.6, 0.03))))
    return Part(solid, (0.0, 0.0, 0.0), (0.2, 0.2, 0.5), 1, "deep holes")


def tray() -> Part:
    """An open tray whose walls and floor are 0.5 % of its length."""
    outer, inner = Box((0.0, 0.0, 0.1), (0.5, 0.3, 0.1)), Box((0.0, 0.0, 0.155), (0.495, 0.295, 0.15))
    return Part(Difference(outer, inner), (0.0, 0.0, 0.1), (0.5, 0.3, 0.1), 0, "a wall of 0.5 %")


def ball() -> Part:
    """A sphere."""
    return Part(Sphere((0.0, 0.0, 0.0), 0.5), (0.0, 0.0, 0.0), (0.5, 0.5, 0.5), 0, "a sphere")


def ring() -> Part:
    """A torus, tube 0.12."""
    return Part(Torus((0.0, 0.0, 0.0), UP, 0.38, 0.12), (0.0, 0.0, 0.0), (0.5, 0.5, 0.12), 1, "a torus")


def joint() -> Part:
    """A ball on a rod on a plate, all sharp where they meet."""
    plate, rod = Box((0.0, 0.0, 0.04), (0.35, 0.25, 0.04)), upright(0.0, 0.0, 0.05, 0.75, 0.07)
    solid = Union((plate, rod, Sphere((0.0, 0.0, 0.8), 0.2)))
    return Part(solid, (0.0, 0.0, 0.5), (0.35, 0.25, 0.5), 0, "a ball on a rod")


def lens() -> Part:
    """Two spheres' intersection, with a bore."""
    spheres = Intersection((Sphere((0.0, 0.0, -0.8), 0.943), Sphere((0.0, 0.0, 0.8), 0.943)))
    solid = Difference(spheres, upright(0.0, 0.0, -0.3, 0.3, 0.06))
    return Part(solid, (0.0, 0.0, 0.0), (0.5, 0.5, 0.143), 1, "a lens with a bore")


def shaft() -> Part:
    """A stepped shaft with two round grooves and a cone for a tip."""
    tip = Intersection(
        (Cone((0.0, 0.0, 0.5), (0.0, 0.0, -1.0), math.radians(25.0)), Plane((0, 0, 0.25), (0, 0, -1)))
    )
    body = Union((upright(0, 0, -0.5, 0.0, 0.2), upright(0, 0, -0.1, 0.3, 0.1166), tip))
    grooves = Union((Torus((0.0, 0.0, -0.3), UP, 0.2, 0.03), Torus((0.0, 0.0, 0.12), UP, 0.1166, 0.02)))
    return Part(Difference(body, grooves), (0.0, 0.0, 0.0), (0.2, 0.2, 0.5), 0, "grooves and a cone")


def grille() -> Part:
    """A plate 0.03 thick with 24 holes."""
    plate = Box((0.0, 0.0, 0.0), (0.5, 0.35, 0.015))
    holes = [upright(0.15 * a - 0.375, 0.15 * b - 0.225, -0.1, 0.1, 0.05) for a in range(6) for b in range(4)]
    return Part(Difference(plate, Union(tuple(holes))), (0.0, 0.0, 0.0), (0.5, 0.35, 0.015), 24, "24 holes")


def gap() -> Part:
    """A clamp: a block with a slit 0.012 wide through most of it, and a bore across the slit's end."""
    block, slit = Box((0.0, 0.0, 0.0), (0.5, 0.2, 0.2)), Box((0.2, 0.0, 0.0), (0.35, 0.006, 0.3))
    bore = upright(-0.15, 0.0, -0.3, 0.3, 0.08)
    bolt = CappedCylinder((0.35, 0.0, 0.0), Y, 0.05, 0.3)
    return Part(
        Difference(block, Union((slit, bore, bolt))), (0.0, 0.0, 0.0), (0.5, 0.2, 0.2), 2, "a narrow slit"
    )


PARTS = (fins, deep_holes, tray, ball, ring, joint, lens, shaft, grille, gap)


def exact_planes(part: Part) -> Measure:
    """The planes of a part's exact field near points of the mesher's frame: its gradient, nothing rounded."""
    centre, scale = torch.tensor(part.centre, dtype=torch.float64), max(part.half)

    def planes(points: Points) -> Planes:
        world = (torch.from_numpy(points) * scale + centre).requires_grad_()
        value = part.solid(world)
        (slope,) = torch.autograd.grad(value.sum(), world)
        normals = (slope / slope.norm(dim=1, keepdim=True)).numpy()
        foot = points - value.detach().numpy()[:, None] / scale * normals
        return Planes(foot, normals, np.zeros(len(points)))

    return planes


def true_mesh(part: Part) -> Mesh:
    """With vertices on the exact surface and on its edges."""
    return solid_mesh(part, RESOLUTION, SharpContour(exact_planes(part)))


def off(solid: Shape, points: Points) -> float:
    """The greatest |f| at points, f the exact field."""
    return float(solid(torch.from_numpy(points)).abs().max())


def main() -> int:
    """Write truths and scans, and how true they are."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, metavar="OUT")
    parser.add_argument("--points", type=int, default=30_000)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    for make in PARTS:
        part, name = make(), make.__name__
        mesh, points = true_mesh(part), sample_solid(part, chosen.points, chosen.seed)
        write_mesh(chosen.out / f"{name}.ply", mesh)
        write_cloud(chosen.out / f"{name}.cloud.ply", points)
        shape, forth = topology(mesh), off(part.solid, sample_surface(mesh, SAMPLES, 0)[0])
        back = float(closest(mesh, points).distance.max())
        right = "" if (shape.components, shape.genus) == (1, part.genus) else "  NOT THE DESIGNED TOPOLOGY"
        sys.stdout.write(
            f"{name}: {part.description}; genus {shape.genus}; mesh to exact surface at most {forth:.1e}, "
            f"exact points to mesh at most {back:.1e}{right}\n"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""What `weingarten measure` reads off parts whose primitives are known in closed form.

    python runs/measure.py OUT [--parts flange shaft ...] [--noise 0.001 ...] [--table]

The bundled parts and those of exact_parts.py: 30,000 points on the exact surface (and again with noise, of
standard deviations in shares of the longest side), a fit with the default settings, its measurement, and that
compared with the surfaces that the part was made of. OUT keeps a run folder for each; what is there is not
fitted again. --table writes results/measure.md. Run it with the Python that has weingarten.
"""

import argparse
import math
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from exact_parts import PARTS as EXACT_PARTS

from weingarten.calculus import exact
from weingarten.device import chosen_device
from weingarten.fit.run_folder import opened
from weingarten.io.mesh import read_mesh
from weingarten.measure.axis import Axis
from weingarten.measure.cone import Cone
from weingarten.measure.cylinder import Cylinder
from weingarten.measure.measurement import Measurement, measurement
from weingarten.measure.plane import Plane
from weingarten.measure.primitive import Primitive
from weingarten.measure.sphere import Sphere
from weingarten.measure.surface import Surface, unit
from weingarten.measure.torus import Torus
from weingarten.reconstruction import reconstruct
from weingarten.report.provenance import commit, machine, today
from weingarten.samples.parts import PARTS, Part, sample_solid
from weingarten.samples.patches import Points, primitives
from weingarten.world_field import WorldField

ROOT = Path(__file__).resolve().parent.parent
POINTS, SEED = 30_000, 0
KNOWN = {**PARTS, **{make.__name__: make() for make in EXACT_PARTS}}

SEEN = 20
"""A surface is one of the part's if so many points of the scan are on it."""

NEAR, TURNED = 0.02, math.radians(2.0)
"""A primitive is the true one of its kind if its radii, and its place in longest sides, are nearer than the
first, and its direction than the second. How near is in the table."""


@dataclass
class Row:
    """Of one part. errors: the greatest of radii (shares), directions (radians), places (lengths)."""

    true: int
    missed: list[str]
    false: list[str]
    pieces: int
    free: float
    seconds: float = 0.0
    errors: dict[str, float] = field(default_factory=dict)


def axis_of(centre: exact.Vector, direction: exact.Vector) -> Axis:
    """Of a shape."""
    return Axis(np.asarray(centre, dtype=np.float64), unit(np.asarray(direction, dtype=np.float64)))


def surfaces(shape: exact.Shape) -> list[Surface]:
    """Those that a primitive solid is bounded by."""
    match shape:
        case exact.Box():
            centre, half = np.asarray(shape.centre), np.asarray(shape.half)
            return [Plane(centre + sign * half * e, sign * e) for e in np.eye(3) for sign in (-1.0, 1.0)]
        case exact.CappedCylinder():
            axis = axis_of(shape.centre, shape.axis)
            ends = [axis.at(sign * shape.half_height).position for sign in (-1.0, 1.0)]
            return [Cylinder(axis, shape.radius), *(Plane(end, axis.direction) for end in ends)]
        case exact.Sphere():
            return [Sphere(np.asarray(shape.centre), shape.radius)]
        case exact.Torus():
            return [Torus(axis_of(shape.centre, shape.axis), shape.ring, shape.tube)]
        case exact.Cone():
            axis = axis_of(shape.apex, shape.axis).at(1.0)
            return [Cone(axis, math.tan(shape.half_angle), shape.half_angle)]
        case exact.Plane():
            return [Plane(np.asarray(shape.centre), unit(np.asarray(shape.normal, dtype=np.float64)))]
        case _:
            raise TypeError(f"no surfaces are written for {type(shape).__name__}")


def truths(part: Part, side: float) -> list[Surface]:
    """The different surfaces that a part shows, told from a scan without noise."""
    points, found = sample_solid(part, POINTS, SEED), []
    for surface in (one for leaf in primitives(part.solid) for one in surfaces(leaf)):
        on = np.count_nonzero(np.abs(surface.distance(points)) < 1e-9 * side)
        if on >= SEEN and not any(max(errors(surface, other, side)) < 1e-6 for other in found):
            found.append(surface)
    return found


def errors(found: Surface, true: Surface, side: float) -> tuple[float, float, float]:
    """Of radii, relative; direction, radians; place, longest sides. Infinite if of another kind."""
    match found, true:
        case Plane(), Plane():
            return (
                0.0,
                angle(found.normal, true.normal),
                abs(float(true.distance(found.position[None])[0])) / side,
            )
        case Sphere(), Sphere():
            away = float(np.linalg.norm(found.position - true.position))
            return abs(found.radius / true.radius - 1.0), 0.0, away / side
        case Cylinder(), Cylinder():
            away = float(true.axis.distance(found.axis.position[None])[0])
            return abs(found.radius / true.radius - 1.0), lean(found.axis, true.axis), away / side
        case Cone(), Cone():
            away = float(np.linalg.norm(found.apex - true.apex))
            return abs(found.half_angle / true.half_angle - 1.0), lean(found.axis, true.axis), away / side
        case Torus(), Torus():
            away = float(np.linalg.norm(found.axis.position - true.axis.position))
            radii = abs(found.major / true.major - 1.0), abs(found.minor / true.minor - 1.0)
            return max(radii), lean(found.axis, true.axis), away / side
        case _:
            return math.inf, math.inf, math.inf


def angle(one: Points, other: Points) -> float:
    """Between two unit vectors of either sign."""
    return math.asin(min(1.0, float(np.linalg.norm(np.cross(one, other)))))


def lean(one: Axis, other: Axis) -> float:
    """Between two axes."""
    return angle(one.direction, other.direction)


def compared(found: tuple[Primitive, ...], free: float, part: Part) -> Row:
    """Every primitive with the true surface that it is."""
    side = 2.0 * max(part.half)
    true, hit, greatest = truths(part, side), [], [0.0, 0.0, 0.0]
    false = []
    for one in found:
        each = [errors(one.surface, other, side) for other in true]
        best = min(range(len(true)), key=lambda n: max(each[n]))
        radius, turn, place = each[best]
        if radius > NEAR or turn > TURNED or place > NEAR:
            false.append(f"{one.kind} of {one.points} points")
            continue
        hit.append(best)
        greatest = [max(pair) for pair in zip(greatest, each[best], strict=True)]
    missed = [true[n].KIND for n in range(len(true)) if n not in hit]
    row = Row(len(true), missed, false, len(hit), free)
    row.errors = dict(zip(("radius", "turn", "place"), greatest, strict=True))
    return row


def measured(name: str, noise: float, out: Path) -> tuple[Measurement, float]:
    """The measurement of a part's fit, which is made where there is none; and its seconds."""
    part, folder = KNOWN[name], out / (f"{name}.run" if noise == 0.0 else f"{name}-{noise:g}.run")
    if not (folder / "mesh.ply").exists():
        points = sample_solid(part, POINTS, SEED)
        spread = noise * 2.0 * max(part.half)
        points = points + np.random.default_rng(SEED).normal(0.0, 1.0, points.shape) * spread
        reconstruct(points, run_folder=folder)
    checkpoint, points = opened(folder)
    mesh, world = read_mesh(folder / "mesh.ply"), WorldField.of(checkpoint, chosen_device("cpu"))
    started = time.perf_counter()
    return measurement(mesh, world, points), time.perf_counter() - started


def cells(name: str, noise: float, row: Row) -> list[str]:
    """A line of the table."""
    return [
        name,
        f"{100 * noise:g} %",
        f"{row.true - len(row.missed)} of {row.true}"
        + (f" (not: {counted(row.missed)})" if row.missed else ""),
        str(row.pieces),
        f"{len(row.false)}" + (f" ({counted(row.false)})" if row.false else ""),
        *(f"{row.errors[key]:.1e}" for key in ("radius",)),
        f"{math.degrees(row.errors['turn']):.1e}",
        f"{row.errors['place']:.1e}",
        f"{100 * row.free:.1f} %",
        f"{row.seconds:.1f}",
    ]


def counted(names: list[str]) -> str:
    """Names, with how often each is there."""
    return ", ".join(f"{names.count(name)} × {name}" for name in dict.fromkeys(names))


def table(rows: list[list[str]]) -> str:
    """The page."""
    heads = [
        "part",
        "noise",
        "surfaces found",
        "primitives on them",
        "false",
        "radius or cone angle, relative",
    ]
    heads += ["direction, degrees", "place, longest sides", "free-form", "seconds"]
    lines = [
        "# Primitives of parts that are known in closed form",
        "",
        "- command: `python runs/measure.py OUT --table`",
        f"- commit: {commit(ROOT)}; date: {today()}; machine: {machine()}",
        f"- {POINTS:,} points of each part, fitted with the default settings; noise: s.d. in longest sides",
        "- errors: the greatest over all primitives that are on a true surface; false: on none. More "
        "primitives than surfaces: separate faces in one plane, or pieces",
        "",
        "| " + " | ".join(heads) + " |",
        "|---" * 2 + "|---:" * (len(heads) - 2) + "|",
        *("| " + " | ".join(row) + " |" for row in rows),
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Measure, compare, and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, metavar="OUT")
    parser.add_argument("--parts", nargs="+", default=list(KNOWN), choices=list(KNOWN), metavar="PART")
    parser.add_argument("--noise", nargs="+", type=float, default=[0.0], metavar="S")
    parser.add_argument("--table", action="store_true", help="write results/measure.md")
    chosen = parser.parse_args()
    torch.set_num_threads(1)
    rows = []
    for noise in chosen.noise:
        for name in chosen.parts:
            found, seconds = measured(name, noise, chosen.out)
            row = compared(found.primitives, found.free_share, KNOWN[name])
            row.seconds = seconds
            rows.append(cells(name, noise, row))
            sys.stdout.write("  ".join(rows[-1]) + "\n")
            sys.stdout.flush()
    if chosen.table:
        (ROOT / "results" / "measure.md").write_text(table(rows), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""`weingarten measure`: what a reverse engineer reads off a fitted part."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli.importing import importing
from weingarten.errors import InputError

if TYPE_CHECKING:
    from weingarten.mesh import Mesh

EXAMPLE = """\
examples:
  weingarten measure part.run
  weingarten measure part.run --json > part.json
  weingarten measure part.run -o part-primitives.json

RUN gets primitives.json, which is the object that --json prints, and labels.npy: for every vertex of its
mesh.ply the number of its primitive, or -1 where the surface is free-form.
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "measure",
        help="list a fitted part's planes, cylinders, cones, spheres and tori",
        description="Find planes, cylinders, cones, spheres and tori on a fitted part, with their sizes.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("folder", metavar="RUN", type=Path, help="run folder of `weingarten fit --run`")
    verb.add_argument("-o", "--output", metavar="FILE", type=Path, help="write the JSON there as well")
    verb.add_argument("--device", default="auto", metavar="NAME", help="auto, cpu, cuda or mps")
    verb.add_argument("--json", action="store_true", help="print one JSON object instead of the table")
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Measure, write and print.

    Raises CheckpointError for a folder without a readable checkpoint, InputError for one without a mesh.
    """
    with importing():
        from weingarten.atomic import check_writable
        from weingarten.device import chosen_device
        from weingarten.fit.run_folder import PRIMITIVES, opened
        from weingarten.measure.files import write_json, write_measurement
        from weingarten.measure.listing import listing
        from weingarten.measure.measurement import measurement
        from weingarten.world_field import WorldField

    folder = arguments.folder
    checkpoint, points = opened(folder)
    mesh = mesh_of(folder)
    check_writable(folder / PRIMITIVES)
    if arguments.output is not None:
        check_writable(arguments.output)
    if checkpoint.step < checkpoint.origin.settings.steps:
        steps = f"{checkpoint.step} of {checkpoint.origin.settings.steps}"
        sys.stderr.write(f"Note: The fit is unfinished, at step {steps}; its sizes may be off.\n")
    field = WorldField.of(checkpoint, chosen_device(arguments.device))
    found = measurement(mesh, field, points)
    write_measurement(folder, found)
    if arguments.output is not None:
        write_json(arguments.output, found)
    sys.stdout.write(
        (json.dumps(found.as_dict(), allow_nan=False) if arguments.json else listing(found)) + "\n"
    )
    return 0


def mesh_of(folder: Path) -> Mesh:
    """The mesh of a run folder, world units. Raises InputError where there is none."""
    from weingarten.io.mesh import read_mesh

    path = folder / "mesh.ply"
    if not path.exists():
        raise InputError(f"{folder} has no mesh yet; make one with `weingarten mesh {folder} -o {path}`.")
    return read_mesh(path)

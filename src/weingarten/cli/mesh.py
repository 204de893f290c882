"""`weingarten mesh`: the surface of a finished or half-finished run, otherwise than the fit made it."""

import argparse
import json
import sys
from pathlib import Path

from weingarten.cli.importing import importing
from weingarten.cli.switch import SWITCH

TRIM_HELP = "leave out surface farther than this from all points, in the cloud's unit; the mesh is open then"
SIMPLIFY_HELP = "fewer triangles: let the surface move by D, in the cloud's unit (extra simplify)"
EXAMPLE = "example: weingarten mesh part.run -o part-fine.stl --resolution 512"


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "mesh",
        help="extract a mesh again from a run folder",
        description="Extract the surface of a finished or half-finished fit from its run folder.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("folder", metavar="RUN", type=Path, help="run folder of `weingarten fit --run`")
    verb.add_argument("-o", "--output", metavar="MESH", type=Path, required=True, help="mesh to write")
    verb.add_argument(
        "--resolution",
        type=int,
        metavar="N",
        help="cells along the longest side, up to twice as many for thin walls; as in the fit by default",
    )
    verb.add_argument(
        "--sharp", choices=SWITCH, help="vertices on sharp edges or not (default: as in the fit)"
    )
    verb.add_argument("--trim-distance", type=float, metavar="D", help=TRIM_HELP)
    verb.add_argument("--simplify", type=float, metavar="D", help=SIMPLIFY_HELP)
    verb.add_argument("--device", default="auto", metavar="NAME", help="auto, cpu, cuda or mps")
    verb.add_argument("--json", action="store_true", help="one JSON object on the standard output")
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Extract and write. Raises CheckpointError for a folder without a readable checkpoint."""
    with importing():
        from weingarten.cli.memory import keep_freed_memory
        from weingarten.device import chosen_device
        from weingarten.fit.run_folder import opened
        from weingarten.io.mesh import check_mesh_path, write_mesh
        from weingarten.reconstruction import remesh
        from weingarten.settings import check_length, check_range

    if arguments.resolution is not None:
        check_range("--resolution", arguments.resolution, 8, 4096)
    lengths = {"--trim-distance": arguments.trim_distance, "--simplify": arguments.simplify}
    trim, simplify = (None if given is None else check_length(name, given) for name, given in lengths.items())
    check_mesh_path(arguments.output)
    keep_freed_memory()
    found, points = opened(arguments.folder)
    device, sharp = chosen_device(arguments.device), SWITCH.get(arguments.sharp)
    mesh, notes = remesh(found, points, device, arguments.resolution, sharp, trim, simplify)
    notes += write_mesh(arguments.output, mesh)
    for note in notes:
        sys.stderr.write(f"Note: {note}\n")
    steps = f"step {found.step} of {found.origin.settings.steps}"
    if arguments.json:
        figures = {"mesh": str(arguments.output), "faces": len(mesh.faces), "step": found.step}
        sys.stdout.write(json.dumps(figures) + "\n")
    else:
        sys.stdout.write(f"Wrote {arguments.output}: {len(mesh.faces):,} triangles, {steps}.\n")
    return 0

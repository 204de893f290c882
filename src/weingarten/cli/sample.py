"""`weingarten sample`: points from a surface, as a scanner would give them, for trials and benchmarks."""

import argparse
import math
import sys
from pathlib import Path

from weingarten.cli import mesh_source
from weingarten.errors import OptionError

MOST_POINTS = 100_000_000
EXAMPLE = """\
examples:
  weingarten sample bundled:flange -o scan.ply
  weingarten sample part.stl -o scan.xyz --points 50000 --noise 0.05 --outliers 0.01
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "sample",
        help="draw points from a mesh or a bundled part",
        description="Draw points uniformly by area from a mesh, or from the exact surface of a bundled part.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("mesh", metavar="MESH", help=mesh_source.HELP)
    verb.add_argument(
        "-o",
        "--output",
        metavar="CLOUD",
        type=Path,
        required=True,
        help="cloud to write: .ply .xyz .txt .csv .npy",
    )
    verb.add_argument("--points", type=int, default=30_000, metavar="N", help="how many points")
    verb.add_argument("--seed", type=int, default=0, metavar="N", help="seed of every random draw")
    verb.add_argument(
        "--noise",
        type=float,
        default=0.0,
        metavar="S",
        help="standard deviation of the noise, in the mesh's unit",
    )
    verb.add_argument(
        "--outliers", type=float, default=0.0, metavar="P", help="fraction of points replaced by outliers"
    )
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the cloud. Raises a WeingartenError that names the option or file at fault."""
    _check(arguments)
    from weingarten.io.cloud_file import check_cloud_path, write_cloud
    from weingarten.scan.sampling import corrupt, sample_surface

    check_cloud_path(arguments.output)
    name = mesh_source.bundled_name(arguments.mesh)
    if name is None:
        points, _ = sample_surface(mesh_source.load(arguments.mesh), arguments.points, arguments.seed)
    else:
        from weingarten.samples.parts import sample_part

        points = sample_part(name, arguments.points, arguments.seed)
    if arguments.noise or arguments.outliers:
        points = corrupt(points, arguments.noise, arguments.outliers, (arguments.seed, 1))
    write_cloud(arguments.output, points)
    sys.stdout.write(f"{len(points):,} points written to {arguments.output}\n")
    return 0


def _check(arguments: argparse.Namespace) -> None:
    if not 1 <= arguments.points <= MOST_POINTS:
        raise OptionError(f"--points must be between 1 and {MOST_POINTS:,}; got {arguments.points}.")
    if arguments.seed < 0:
        raise OptionError(f"--seed must be 0 or more; got {arguments.seed}.")
    if not (math.isfinite(arguments.noise) and arguments.noise >= 0):
        raise OptionError(f"--noise must be a finite length of 0 or more; got {arguments.noise}.")
    if not 0 <= arguments.outliers < 1:
        raise OptionError(f"--outliers must be at least 0 and less than 1; got {arguments.outliers}.")

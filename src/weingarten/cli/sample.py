"""`weingarten sample`: points from a surface, as a scanner would give them, for trials and benchmarks."""

from __future__ import annotations

import argparse
import functools
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli import mesh_source
from weingarten.errors import OptionError

if TYPE_CHECKING:
    from weingarten.scan.flaws import Draw, Points

MOST_POINTS = 100_000_000
MOST_VIEWS = 1000
EXAMPLE = """\
examples:
  weingarten sample bundled:flange -o scan.ply
  weingarten sample part.stl -o scan.xyz --points 50000 --noise 0.05 --outliers 0.01
  weingarten sample part.stl -o scan.ply --views 6 --missing 0.05    seen from six places, a hole in the scan
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
    verb.add_argument(
        "--uneven", type=float, default=1.0, metavar="R", help="so many times as dense at one end of the part"
    )
    verb.add_argument(
        "--missing", type=float, default=0.0, metavar="P", help="share of the surface that is not scanned"
    )
    verb.add_argument(
        "--views", type=int, metavar="K", help="scan only what is seen from K places around the part"
    )
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the cloud. Raises a WeingartenError that names the option or file at fault."""
    _check(arguments)
    from weingarten.io.cloud_file import check_cloud_path, write_cloud
    from weingarten.scan.sampling import corrupt

    check_cloud_path(arguments.output)
    draw = _surface(arguments.mesh)
    if arguments.uneven > 1.0 or arguments.missing or arguments.views:
        points = _flawed(arguments, draw)
    else:
        points = draw(arguments.points, arguments.seed)
    if arguments.noise or arguments.outliers:
        points = corrupt(points, arguments.noise, arguments.outliers, (arguments.seed, 1))
    write_cloud(arguments.output, points)
    sys.stdout.write(f"{len(points):,} points written to {arguments.output}\n")
    return 0


def _surface(source: str) -> Draw:
    """Draws from a mesh, or from the exact surface of a bundled part."""
    name = mesh_source.bundled_name(source)
    if name is None:
        from weingarten.scan.sampling import sample_surface

        mesh = mesh_source.load(source)
        return lambda count, seed: sample_surface(mesh, count, seed)[0]
    from weingarten.samples.parts import sample_part

    return functools.partial(sample_part, name)


def _flawed(arguments: argparse.Namespace, draw: Draw) -> Points:
    """Draws with the flaws that are asked for; each is laid out by a seed of its own."""
    from weingarten.scan import flaws

    seed = arguments.seed
    probe = draw(flaws.PROBE, (seed, 2))
    found: list[flaws.Flaw] = []
    if arguments.views:
        found.append(flaws.visible(mesh_source.load(arguments.mesh), arguments.views, (seed, 3)))
    if arguments.uneven > 1.0:
        found.append(flaws.uneven(arguments.uneven, probe, (seed, 4)))
    if arguments.missing:
        found.append(flaws.missing(arguments.missing, probe, (seed, 5)))
    return flaws.flawed(draw, arguments.points, found, (seed, 6))


def _check(arguments: argparse.Namespace) -> None:
    if not 1 <= arguments.points <= MOST_POINTS:
        raise OptionError(f"--points must be between 1 and {MOST_POINTS:,}; got {arguments.points}.")
    if arguments.seed < 0:
        raise OptionError(f"--seed must be 0 or more; got {arguments.seed}.")
    if not (math.isfinite(arguments.noise) and arguments.noise >= 0):
        raise OptionError(f"--noise must be a finite length of 0 or more; got {arguments.noise}.")
    if not 0 <= arguments.outliers < 1:
        raise OptionError(f"--outliers must be at least 0 and less than 1; got {arguments.outliers}.")
    if not (math.isfinite(arguments.uneven) and arguments.uneven >= 1):
        raise OptionError(f"--uneven must be a ratio of 1 or more; got {arguments.uneven}.")
    if not 0 <= arguments.missing < 1:
        raise OptionError(f"--missing must be at least 0 and less than 1; got {arguments.missing}.")
    if arguments.views is not None and not 1 <= arguments.views <= MOST_VIEWS:
        raise OptionError(f"--views must be between 1 and {MOST_VIEWS}; got {arguments.views}.")

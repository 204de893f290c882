"""`weingarten evaluate`: how far a mesh is from the truth, under a protocol that is printed with it."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING

from weingarten.cli import mesh_source
from weingarten.cli.importing import importing
from weingarten.errors import OptionError

if TYPE_CHECKING:
    from weingarten.metrics.protocol import Figure, Figures

EXAMPLE = """\
examples:
  weingarten evaluate part.stl truth.stl
  weingarten evaluate part.stl bundled:flange --protocol published --json

protocols:
  exact      distances to triangles, one similarity from the truth; sharp edges, topology, volume
  published  that of the published tables: each mesh scaled by its own box, samples against samples
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "evaluate",
        help="compare a mesh with the true one",
        description="Compare a mesh with the true one, under a named protocol.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("mesh", metavar="MESH", help="mesh to judge")
    verb.add_argument("truth", metavar="TRUTH", help=mesh_source.HELP)
    verb.add_argument("--protocol", choices=("exact", "published"), default="exact", help="how to measure")
    verb.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the samples")
    verb.add_argument("--json", action="store_true", help="print one JSON object with raw values instead")
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the figures. Raises a WeingartenError that names the option or file at fault."""
    if arguments.seed < 0:
        raise OptionError(f"--seed must be 0 or more; got {arguments.seed}.")
    with importing():
        from weingarten.metrics.protocol import PROTOCOLS

    mesh, truth = mesh_source.load(arguments.mesh), mesh_source.load(arguments.truth)
    figures = PROTOCOLS[arguments.protocol].evaluate(mesh, truth, arguments.seed)
    sys.stdout.write(json.dumps(figures.as_dict()) + "\n" if arguments.json else table(figures))
    return 0


def table(figures: Figures) -> str:
    """The figures as aligned lines of label, value and unit under the protocol's name."""
    rows = [(figure.label, _shown(figure), figure.unit) for figure in figures.rows()]
    label = max(len(row[0]) for row in rows)
    value = max(len(row[1]) for row in rows)
    lines = [f"  {name:<{label}}  {text:>{value}}  {unit}".rstrip() for name, text, unit in rows]
    return "\n".join([f"protocol {figures.protocol}", *lines]) + "\n"


def _shown(figure: Figure) -> str:
    value = figure.value
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return str(value)
    return f"{value:.2f}" if figure.unit == "%" else f"{value:.4f}"

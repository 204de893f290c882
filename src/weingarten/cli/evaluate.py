"""`weingarten evaluate`: how far a mesh is from the truth, under protocols that are printed with it."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli import mesh_source
from weingarten.cli.importing import importing
from weingarten.errors import InputError, OptionError

if TYPE_CHECKING:
    from weingarten.mesh import Mesh
    from weingarten.metrics.figures import Figures
    from weingarten.world_field import WorldField

EXAMPLE = """\
examples:
  weingarten evaluate part.stl truth.stl
  weingarten evaluate part.stl bundled:flange --protocol both --json
  weingarten evaluate part.run truth.stl

protocols:
  exact      distances to triangles, one similarity from the truth; sharp edges, topology, volume
  published  that of the published tables: each mesh scaled by its own box, samples against samples,
             beside the ceiling: what the truth scores against a sample of itself
A run folder of `weingarten fit --run` is judged by its mesh, and its field by how far it is from the
signed distance to the truth.
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "evaluate",
        help="compare a mesh with the true one",
        description="Compare a mesh with the true one, under a named protocol or two.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("mesh", metavar="MESH", help="mesh to judge, or the run folder of a fit")
    verb.add_argument("truth", metavar="TRUTH", help=mesh_source.HELP)
    verb.add_argument(
        "--protocol", choices=("exact", "published", "both"), default="exact", help="how to measure"
    )
    verb.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the samples")
    verb.add_argument("--json", action="store_true", help="print one JSON object with raw values instead")
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the figures. Raises a WeingartenError that names the option or file at fault."""
    if arguments.seed < 0:
        raise OptionError(f"--seed must be 0 or more; got {arguments.seed}.")
    with importing():
        from weingarten.metrics.protocol import EXACT, FIELD, PUBLISHED

    protocols = {"exact": EXACT.evaluate, "published": PUBLISHED.beside_ceiling}
    mesh, field = judged(arguments.mesh)
    truth = mesh_source.load(arguments.truth)
    found: dict[str, Figures] = {
        name: evaluate(mesh, truth, arguments.seed)
        for name, evaluate in protocols.items()
        if arguments.protocol in (name, "both")
    }
    of_field = None if field is None else FIELD.evaluate(field, truth, arguments.seed)
    every = [*found.values(), *([] if of_field is None else [of_field])]
    for sentence in dict.fromkeys(finding.sentence for one in every for finding in one.findings):
        sys.stderr.write(f"Note: {sentence}\n")
    text = as_json(found, of_field) if arguments.json else "\n\n".join(map(table, every))
    sys.stdout.write(text + "\n")
    return 0


def judged(source: str) -> tuple[Mesh, WorldField | None]:
    """The mesh to judge, world units, and its field where it is that of a run folder.

    Raises InputError, OptionError or CheckpointError for what cannot be read.
    """
    folder = Path(source)
    if not folder.is_dir():
        return mesh_source.load(source), None
    with importing():
        from weingarten.device import chosen_device
        from weingarten.fit.run_folder import opened
        from weingarten.world_field import WorldField

    checkpoint, _ = opened(folder)
    path = folder / "mesh.ply"
    if not path.exists():
        raise InputError(f"{folder} has no mesh yet; make one with `weingarten mesh {folder} -o {path}`.")
    return mesh_source.load(str(path)), WorldField.of(checkpoint, chosen_device("cpu"))


def as_json(found: dict[str, Figures], of_field: Figures | None) -> str:
    """One object: the figures of the one protocol, or of each by its name; those of a field as `field`."""
    answers = {name: figures.as_dict() for name, figures in found.items()}
    answer = answers if len(answers) > 1 else next(iter(answers.values()))
    return json.dumps(answer if of_field is None else answer | {"field": of_field.as_dict()}, allow_nan=False)


def table(figures: Figures) -> str:
    """The figures as aligned lines of label, value, ceiling and unit under the protocol's name."""
    rows = [(row.label, row.text, *row.beside_ceiling, row.unit) for row in figures.rows()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for label, *values, unit in rows:
        cells = [f"{text:>{width}}" for text, width in zip(values, widths[1:-1], strict=True)]
        lines.append("  ".join(["", f"{label:<{widths[0]}}", *cells, unit]).rstrip())
    return "\n".join([f"protocol {figures.protocol}", *lines])

"""`weingarten reproduce figures`: Figures 1 to 4 of arXiv 2511.03147, drawn from data."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli import campaign, reproduction
from weingarten.cli.importing import importing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from weingarten.bench.parts import Part

ROWS = 4
"""Parts in Figure 3 where none are named: the first ones by name."""

END = 2e-3
"""Of Figure 3's scale of colours, unit-cube lengths: one for all budgets, so that figures compare."""

FOLDER = "figures"

DESCRIPTION = f"""\
Draw the paper's figures into DIR/{FOLDER}, as PNG and SVG. Figure 3 shows meshes of the parts of --parts,
else of the first {ROWS} by name, fitted with seed 0. What `reproduce tables` has fitted in DIR is not fitted
again.
"""


def add(made, formatter: type[argparse.HelpFormatter]) -> None:
    """Add it to what can be reproduced."""
    verb = made.add_parser(
        "figures",
        help="Figures 1 to 4, as PNG and SVG",
        description=DESCRIPTION,
        formatter_class=formatter,
    )
    verb.add_argument(
        "--data", type=Path, metavar="PARTS", help="folder of true meshes (without it, no Figure 3)"
    )
    reproduction.add_options(verb)
    campaign.add_fitting(verb)
    verb.set_defaults(run=run, seeds=1, shard="1/1")


def run(arguments: argparse.Namespace) -> int:
    """Draw them. Raises a WeingartenError that names the option or file at fault."""
    with importing():
        from weingarten.cli.memory import keep_freed_memory
        from weingarten.many.records import make_folder
        from weingarten.reproduce.figure_regimes import figure_regimes
        from weingarten.reproduce.figure_schedules import FIGURE_4, figure_schedules

    parts = rows(arguments)
    keep_freed_memory()
    out = reproduction.folder(arguments) / FOLDER
    make_folder(out)
    write(figure_regimes(), out / "figure-1-curvature-regimes")
    write(figure_schedules(), out / "figure-2-schedules")
    write(figure_schedules(FIGURE_4), out / "figure-4-schedules")
    if parts:
        write(qualitative(arguments, parts), out / "figure-3-comparison")
    return 0


def rows(arguments: argparse.Namespace) -> "list[Part]":
    """Those of Figure 3; none and a note without data."""
    from weingarten.bench.parts import parts_in

    if arguments.data is None:
        sys.stderr.write("Note: Figure 3 compares meshes of parts; name their folder with --data.\n")
        return []
    parts = parts_in(arguments.data, campaign.names(arguments.parts))
    return parts if arguments.parts else parts[:ROWS]


def qualitative(arguments: argparse.Namespace, parts: "list[Part]") -> "Figure":
    """Figure 3, with every fit that it needs."""
    from weingarten.bench.lineup import NONE
    from weingarten.reproduce.figure_qualitative import figure_qualitative

    entrants = reproduction.entrants(arguments)
    arguments.parts = ",".join(part.name for part in parts)
    shown = {**entrants.scheduled, **entrants.others}
    del shown[NONE]
    out = reproduction.folder(arguments)
    baseline = entrants.scheduled["constant"].name
    campaign.carried_out(arguments, arguments.data, list(shown.values()), out, baseline)
    return figure_qualitative(out, parts, {heading: one.name for heading, one in shown.items()}, end=END)


def write(figure: "Figure", path: Path) -> None:
    """As both files, named on the standard output."""
    from weingarten.reproduce.save import write_figure

    sys.stdout.write("".join(f"Wrote {made}\n" for made in write_figure(figure, path)))
    sys.stdout.flush()

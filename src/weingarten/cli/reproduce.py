"""`weingarten reproduce`: the tables of arXiv 2511.03147, made anew."""

import argparse
import importlib.util
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli import campaign
from weingarten.cli.importing import importing

if TYPE_CHECKING:
    from weingarten.bench.table import Table

EXAMPLE = """\
examples:
  weingarten reproduce tables --data parts/
  weingarten reproduce tables --data parts/ --weight 3
  weingarten reproduce tables --data parts/ --preset paper --parts a,b --points-per-step 2000 --seeds 1

Every schedule on every part, seed after seed; the same command goes on after an interruption, and
DIR/paper-tables.md, results.csv and tables.md are written in any case. `weingarten report DIR` makes a page.
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "reproduce",
        help="the paper's tables, made anew",
        description="Make the tables of arXiv 2511.03147 anew, beside the published ones.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("what", choices=("tables",), help="what to make")
    verb.add_argument("--data", type=Path, required=True, metavar="PARTS", help="folder of true meshes")
    verb.add_argument("--out", type=Path, metavar="DIR", help="where all goes (default: reproduced-PRESET)")
    verb.add_argument("--weight", type=float, default=10.0, metavar="W", help="greatest one of a schedule")
    campaign.add_options(verb, seeds=3)
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Make them. Raises a WeingartenError that names the option or file at fault."""
    return {"tables": tables}[arguments.what](arguments)


def tables(arguments: argparse.Namespace) -> int:
    """Tables 1 and 2."""
    with importing():
        from weingarten.bench.rendering import plain
        from weingarten.bench.results import results
        from weingarten.bench.store import Store
        from weingarten.reproduce.tables import Entrants, paper_tables

    poisson = importlib.util.find_spec("gpytoolbox") is not None
    if not poisson:
        sys.stderr.write('Note: screened Poisson is left out; for it, pip install "weingarten[bench]".\n')
    entrants = Entrants.of(campaign.budget(arguments), arguments.weight, arguments.oracle, poisson)
    out = folder(arguments)
    baseline = entrants.scheduled["constant"].name
    try:
        campaign.carried_out(arguments, arguments.data, entrants.everyone, out, baseline)
    finally:
        made = paper_tables(results(Store(out)), entrants)
        write(made, out / "paper-tables.md")
    sys.stdout.write("\n".join(plain(table) for table in made))
    sys.stdout.write(
        f"\nAlso in {out / 'paper-tables.md'}; differences and all else in {out / 'tables.md'}\n"
    )
    return 0


def folder(arguments: argparse.Namespace) -> Path:
    """Where everything goes."""
    return arguments.out or Path(f"reproduced-{arguments.preset}")


def write(made: "list[Table]", path: Path) -> None:
    """All as one page, if there is a folder."""
    from weingarten.atomic import replacing
    from weingarten.bench.rendering import markdown

    if path.parent.is_dir():
        with replacing(path) as temporary:
            text = "# arXiv 2511.03147, Tables 1 and 2\n\n" + "\n".join(map(markdown, made))
            temporary.write_text(text, encoding="utf-8")

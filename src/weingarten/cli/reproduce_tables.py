"""`weingarten reproduce tables`: Tables 1 and 2 of arXiv 2511.03147, beside the published ones."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli import campaign, reproduction
from weingarten.cli.importing import importing

if TYPE_CHECKING:
    from weingarten.bench.table import Table


def add(made, formatter: type[argparse.HelpFormatter]) -> None:
    """Add it to what can be reproduced."""
    verb = made.add_parser(
        "tables",
        help="Tables 1 and 2, and who else takes part",
        description="Fit every part under every schedule, and make the paper's tables.",
        formatter_class=formatter,
    )
    verb.add_argument("--data", type=Path, required=True, metavar="PARTS", help="folder of true meshes")
    reproduction.add_options(verb)
    campaign.add_options(verb, seeds=3)
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Make them. Raises a WeingartenError that names the option or file at fault."""
    with importing():
        from weingarten.bench.rendering import plain
        from weingarten.bench.results import results
        from weingarten.bench.store import Store
        from weingarten.reproduce.tables import paper_tables

    entrants = reproduction.entrants(arguments)
    out = reproduction.folder(arguments)
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


def write(made: "list[Table]", path: Path) -> None:
    """All as one page, if there is a folder."""
    from weingarten.atomic import replacing
    from weingarten.bench.rendering import markdown

    if path.parent.is_dir():
        with replacing(path) as temporary:
            text = "# arXiv 2511.03147, Tables 1 and 2\n\n" + "\n".join(map(markdown, made))
            temporary.write_text(text, encoding="utf-8")

"""`weingarten bench`: methods and schedules compared on a folder of parts."""

import argparse
import sys
from pathlib import Path

from weingarten.cli import campaign
from weingarten.cli.importing import importing
from weingarten.errors import OptionError

EXAMPLE = """\
examples:
  weingarten bench parts/ --schedules constant,linear,quintic --seeds 3 --out compared
  weingarten bench parts/ --methods odw,odw-fd,poisson --out methods --baseline poisson
  weingarten bench parts/ --methods odw,digs@400 --out equal-time   DiGS with 400 steps of its own
  weingarten bench parts/ --shard 2/4 --out compared        one of four machines, one shared folder

PARTS holds true meshes, NAME.stl and so on; a scan beside one is NAME.cloud.ply. Without it the truth is
sampled. The same command goes on after an interruption: what is finished is never made again.
DIR gets results.csv, results.json and tables.md; `weingarten report DIR` makes a page of it.
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "bench",
        help="compare methods and schedules on a folder of parts",
        description="Fit every part by every method under every schedule, and compare with the truth.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("data", metavar="PARTS", type=Path, help="folder of true meshes")
    verb.add_argument("--out", type=Path, required=True, metavar="DIR", help="where everything goes")
    verb.add_argument("--methods", metavar="A,B", help="as in fit; also poisson (default: the preset's)")
    verb.add_argument("--schedules", default="own", metavar="A,B", help="as in fit; own is the method's")
    verb.add_argument("--weight", type=float, metavar="W", help="greatest weight of named schedules")
    verb.add_argument("--baseline", metavar="NAME", help="contender to compare with (default: the first)")
    campaign.add_options(verb, seeds=1)
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Make, judge and tabulate. Raises a WeingartenError that names the option or file at fault."""
    with importing():
        from weingarten.bench.lineup import lineup
        from weingarten.bench.rendering import plain

    settings = campaign.budget(arguments)
    methods = campaign.names(arguments.methods) or [settings.method]
    schedules = campaign.names(arguments.schedules)
    contenders = lineup(methods, schedules, settings, arguments.weight, arguments.oracle)
    if arguments.baseline is not None and arguments.baseline not in [one.name for one in contenders]:
        known = ", ".join(one.name for one in contenders)
        raise OptionError(f"--baseline {arguments.baseline} takes no part; choose one of {known}.")
    baseline = arguments.baseline or contenders[0].name
    made = campaign.carried_out(arguments, arguments.data, contenders, arguments.out, baseline)
    sys.stdout.write("".join(plain(table) for table in made[:1]))
    sys.stdout.write(f"Spread, differences and all else: {arguments.out / 'tables.md'}\n")
    return 0

"""`weingarten report`: one page about a fit or about a benchmark, with plots, pictures and a view in 3D."""

import argparse
import sys
from pathlib import Path

from weingarten.cli.importing import importing

EXAMPLE = """\
examples:
  weingarten report part.run                      writes part.run/report.html, about one fit
  weingarten report compared                      writes compared/report.html, about a benchmark
  weingarten report compared -o page.html

The page is one file that any browser opens, offline too. It shows what is there: run it again when more fits
of a benchmark are done, or when an interrupted fit has gone on.
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "report",
        help="make a page about a fit or a benchmark",
        description="Make one HTML page: about a fit, with its verdict, deviations in colour, figures, loss "
        "curves and settings; or about a benchmark, with tables, distributions, loss curves and errors. Both "
        "with a view in 3D.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("folder", metavar="DIR", type=Path, help="--run of a fit, or --out of a benchmark")
    verb.add_argument("-o", "--output", metavar="FILE", type=Path, help="page (default: DIR/report.html)")
    verb.add_argument("--quiet", action="store_true", help="no progress")
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the page. Raises a WeingartenError that names the folder or file at fault."""
    from weingarten.report.template import check_page_name

    path = arguments.output or arguments.folder / "report.html"
    check_page_name(path)
    with importing():
        from weingarten.cli.memory import keep_freed_memory
        from weingarten.report.kinds import kind_of
        from weingarten.report.page import Watcher

    class Lines(Watcher):
        """A line a part."""

        def part(self, name: str, number: int, of: int) -> None:
            """See Watcher."""
            sys.stderr.write(f"[{number}/{of}] {name}\n")
            sys.stderr.flush()

    keep_freed_memory()
    kind = kind_of(arguments.folder)
    made = kind.write(arguments.folder, path, Watcher() if arguments.quiet else Lines())
    sys.stdout.write(f"Wrote {path}: {made}.\n")
    return 0

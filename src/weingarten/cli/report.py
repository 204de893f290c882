"""`weingarten report`: one page about a benchmark, with tables, plots, pictures and a view in 3D."""

import argparse
import sys
from pathlib import Path

from weingarten.cli.importing import importing
from weingarten.errors import OutputError

FORMATS = (".html", ".htm")
EXAMPLE = """\
examples:
  weingarten report compared                      writes compared/report.html
  weingarten report compared -o page.html

The page is one file that any browser opens, offline too. It shows what is there: run it again when more fits
of the benchmark are done.
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "report",
        help="make a page about a benchmark",
        description="Make one HTML page about a benchmark: tables, distributions, loss curves, errors, 3D.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("folder", metavar="DIR", type=Path, help="folder of a benchmark, its --out")
    verb.add_argument("-o", "--output", metavar="FILE", type=Path, help="page (default: DIR/report.html)")
    verb.add_argument("--quiet", action="store_true", help="no progress")
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the page. Raises a WeingartenError that names the folder or file at fault."""
    path = arguments.output or arguments.folder / "report.html"
    if path.suffix.lower() not in FORMATS:
        raise OutputError(f"{path} is to be a page; end its name in .html.")
    with importing():
        from weingarten.cli.memory import keep_freed_memory
        from weingarten.report.page import Watcher, write_page

    class Lines(Watcher):
        """A line a part."""

        def part(self, name: str, number: int, of: int) -> None:
            """See Watcher."""
            sys.stderr.write(f"[{number}/{of}] {name}\n")
            sys.stderr.flush()

    keep_freed_memory()
    made = write_page(arguments.folder, path, Watcher() if arguments.quiet else Lines())
    counts = f"{made.fits} fits, {made.contenders} contenders, {made.parts} parts"
    sys.stdout.write(f"Wrote {path}: {counts}, {made.size / 1e6:.1f} MB.\n")
    return 0

"""Entry point: parse, hand to the verb, turn the user's errors into one sentence and exit code 2.

Nothing heavy is imported before a verb runs, so that `weingarten --help` answers at once.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

from weingarten.cli import bench, doctor, evaluate, fit, measure, mesh, report, reproduce, sample, view
from weingarten.errors import WeingartenError

VERBS = (fit, mesh, view, measure, sample, evaluate, bench, report, reproduce, doctor)


class Formatter(argparse.ArgumentDefaultsHelpFormatter, argparse.RawDescriptionHelpFormatter):
    """Defaults after every option that has one, examples left as written."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=28, width=100)

    def _get_help_string(self, action: argparse.Action) -> str | None:
        """Without "(default: None)" and the like."""
        bare = action.default is None or action.default is False
        return action.help if bare else super()._get_help_string(action)


def parser() -> argparse.ArgumentParser:
    """The whole command line: one level of subcommands."""
    root = argparse.ArgumentParser(
        prog="weingarten",
        description="Unoriented points of a CAD part in, a clean watertight mesh out.",
        epilog="Start with:  weingarten fit scan.ply -o part.stl",
    )
    root.add_argument("--version", action="store_true", help="print the version and leave")
    verbs = root.add_subparsers(title="verbs", metavar="VERB", dest="verb")
    for verb in VERBS:
        verb.add(verbs, Formatter)
    return root


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Returns the exit code: 0 done, 1 some of many failed, 2 the user's error, 130 interrupted.
    """
    root = parser()
    arguments = root.parse_args(argv)
    if arguments.version:
        from importlib.metadata import version

        sys.stdout.write(f"weingarten {version('weingarten')}\n")
        return 0
    if arguments.verb is None:
        root.print_help()
        return 0
    try:
        return arguments.run(arguments)
    except WeingartenError as error:
        sys.stderr.write(f"weingarten {arguments.verb}: {error}\n")
        return 2
    except KeyboardInterrupt:
        sys.stderr.write(f"weingarten {arguments.verb}: interrupted.\n")
        return 130


def command() -> NoReturn:
    """The installed command: main, without the half second that torch takes to be taken apart at the end."""
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)

"""`weingarten reproduce`: the tables and figures of arXiv 2511.03147, made anew."""

import argparse

from weingarten.cli import reproduce_figures, reproduce_tables

EXAMPLE = """\
examples:
  weingarten reproduce tables --data parts/
  weingarten reproduce tables --data parts/ --weight 3
  weingarten reproduce tables --data parts/ --preset paper --parts a,b --points-per-step 2000 --seeds 1
  weingarten reproduce figures --data parts/

Every schedule on every part, seed after seed; the same command goes on after an interruption, and
DIR/paper-tables.md, results.csv and tables.md are written in any case. `weingarten report DIR` makes a page.
"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "reproduce",
        help="the paper's tables and figures, made anew",
        description="Make the tables or the figures of arXiv 2511.03147 anew.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    made = verb.add_subparsers(dest="what", metavar="tables|figures", required=True)
    for what in (reproduce_tables, reproduce_figures):
        what.add(made, formatter)

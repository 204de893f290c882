"""All benchmarks, one after the other, as one Markdown page.

    python benchmarks [--baseline] [--largest 1000000] [-o FILE]

Nothing runs beside anything else but the contenders of step.py, which take turns. With -o the page is written
to a file as well, whole or not at all.
"""

import argparse
import shlex
import sys
from pathlib import Path

from process import measured
from scaling import CLOUDS

from weingarten.atomic import check_writable, replacing
from weingarten.errors import OutputError
from weingarten.report.provenance import commit, machine, today

HEADINGS = {
    "step": "One optimisation step",
    "methods": "A step of every method",
    "phases": "The whole command",
    "quality": "Time to quality",
    "scaling": "How time and memory grow",
    "batched": "Many parts at once",
}
FOLDER = Path(__file__).resolve().parent
ROOT = FOLDER.parent


def section(name: str, options: list[str]) -> str:
    """A script's heading, command and output."""
    sys.stderr.write(f"{name} …\n")
    outcome = measured([sys.executable, str(FOLDER / f"{name}.py"), *options])
    command = shlex.join(["python", f"benchmarks/{name}.py", *options])
    return f"## {HEADINGS[name]}\n\n`{command}`\n\n```text\n{outcome.text}```\n"


def page(options: dict[str, list[str]]) -> str:
    """The page, with what each script is given beside its defaults."""
    sections = [section(name, options.get(name, [])) for name in HEADINGS]
    facts = f"- date: {today()}\n- commit: {commit(ROOT)}\n- machine: {machine()}\n"
    return "\n".join(["# Benchmarks\n", facts, *sections])


def main() -> int:
    """Parse, run, write; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python benchmarks", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--baseline", action="store_true", help="time plain autograd too (many gigabytes)")
    parser.add_argument(
        "--largest", type=int, choices=CLOUDS, default=CLOUDS[-2], help="points of the largest cloud"
    )
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="Markdown file to write")
    arguments = parser.parse_args()
    options = {"scaling": ["--largest", str(arguments.largest)]}
    if arguments.baseline:
        options["step"] = ["--baseline"]
    try:
        if arguments.output is not None:
            check_writable(arguments.output)
        text = page(options)
        sys.stdout.write(text)
        if arguments.output is not None:
            with replacing(arguments.output) as temporary:
                temporary.write_text(text, encoding="utf-8")
    except OutputError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())

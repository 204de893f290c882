"""A picture of some parts of a benchmark: the truth, and what each contender made of it, with its errors.

    python runs/picture.py DATA OUT PICTURE --parts abc_00000168,abc_00016513 --contenders odw,gaussian,siren

DATA holds the true meshes, OUT is what `weingarten bench` wrote; PICTURE.png and PICTURE.svg are made, as
Figure 3 of `weingarten reproduce figures` is. Run it with the Python of the environment that weingarten is
installed in.
"""

import argparse
import sys
from pathlib import Path

from weingarten.bench.parts import parts_in
from weingarten.reproduce.figure_qualitative import figure_qualitative
from weingarten.reproduce.save import write_figure


def main() -> None:
    """Read, draw, write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("data", type=Path, help="folder of true meshes")
    parser.add_argument("out", type=Path, help="folder of a benchmark")
    parser.add_argument("picture", type=Path, help="file to write, without .png or .svg")
    parser.add_argument("--parts", required=True, help="names, one row each")
    parser.add_argument("--contenders", required=True, help="names, one column each")
    parser.add_argument("--seed", type=int, default=0, help="of the fits (default 0)")
    parser.add_argument("--end", type=float, help="of the scale, unit-cube lengths (default: chosen)")
    arguments = parser.parse_args()
    parts = parts_in(arguments.data, arguments.parts.split(","))
    contenders = {name: name for name in arguments.contenders.split(",")}
    figure = figure_qualitative(arguments.out, parts, contenders, arguments.seed, arguments.end)
    for written in write_figure(figure, arguments.picture):
        sys.stdout.write(f"Wrote {written}\n")


if __name__ == "__main__":
    main()

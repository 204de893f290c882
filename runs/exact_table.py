"""How the parts of exact primitives come out, weingarten beside screened Poisson: results/exact-parts.md.

    python runs/exact_parts.py PARTS
    weingarten bench PARTS --methods odw-oriented,poisson --seeds 3 --out BENCH
    python runs/exact_table.py BENCH

Run it with the Python of the environment that has weingarten.
"""

import argparse
import statistics
import sys
from pathlib import Path

from exact_parts import PARTS
from judged import Fits, judged, provenance, right

ROOT = Path(__file__).resolve().parent.parent
METHODS = ("odw-oriented", "poisson")
HEADINGS = ("part", "what", "CD ×10³", "95 % ×10³", "Hausdorff ×10³", "edge F1, %", "topology", "doubts")


def figure(values: list[float | None], digits: int, unit: float) -> str:
    """Mean and s.d.; a dash where a part has nothing of the kind, as a ball has no edges."""
    known = [unit * value for value in values if value is not None]
    if not known:
        return "–"
    spread = statistics.stdev(known) if len(known) > 1 else 0.0
    return f"{statistics.mean(known):.{digits}f} ({spread:.{digits}f})"


def cells(fits: Fits, part: str) -> list[str]:
    """Of one part by one method."""
    own = [one for (name, _), one in fits.items() if name == part]
    if not own:
        return ["–"] * 6
    wrong = ", ".join(f"{one['components']}/{one['genus']}" for one in own if not right(one))
    return [
        figure([one["chamfer"] for one in own], 3, 1000),
        figure([one["distance_95"] for one in own], 2, 1000),
        f"{1000 * max(one['hausdorff'] for one in own):.1f}",
        figure([one["edge_f1"] for one in own], 0, 100),
        f"{sum(map(right, own))} of {len(own)}" + (f"; else {wrong}" if wrong else ""),
        f"{sum(one['said'] for one in own)}",
    ]


def table(bench: Path, method: str) -> list[str]:
    """Every part's row."""
    fits = judged(bench, method)
    lines = ["| " + " | ".join(HEADINGS) + " |", "|---|---|" + "---:|" * (len(HEADINGS) - 2)]
    for make in PARTS:
        part = make()
        what = f"{part.description}, genus {part.genus}"
        lines.append("| " + " | ".join([make.__name__, what, *cells(fits, make.__name__)]) + " |")
    return lines


def main() -> int:
    """Write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("bench", type=Path, metavar="BENCH")
    chosen = parser.parse_args()
    lines = [
        "# Parts of exact primitives",
        "",
        "- commands: `python runs/exact_parts.py PARTS`, `weingarten bench PARTS --methods "
        "odw-oriented,poisson --seeds 3 --out BENCH`, `python runs/exact_table.py BENCH`",
        f"- {provenance(judged(chosen.bench, METHODS[0]))}",
        "- protocol exact-1, 30,000 points on the exact surface; mean (s.d.) over the seeds, Hausdorff: the "
        "worst; topology: right, else components/genus; doubts: of how many fits the summary had some",
    ]
    for method in METHODS:
        lines += ["", f"## {method}", "", *table(chosen.bench, method)]
    (ROOT / "results" / "exact-parts.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    sys.stdout.write("results/exact-parts.md\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

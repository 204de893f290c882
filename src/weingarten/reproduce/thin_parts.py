"""Whether thin parts pay for the curvature term: every schedule against none, by thickness of the walls."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from weingarten.bench.metric import EXACT_METRICS
from weingarten.bench.results import Result
from weingarten.bench.statistics import correlation, figures_of
from weingarten.bench.table import Cell, Table, marked
from weingarten.errors import WeingartenError
from weingarten.io.mesh import read_mesh
from weingarten.mesh import Mesh
from weingarten.metrics.topology import topology
from weingarten.metrics.unit_cube import cube_frame

CHAMFER = EXACT_METRICS[0]

CAPTION = (
    "CD ×10⁻³, protocol exact-1, mean over the seeds, thinnest part first; best bold, second underlined. "
    "Thickness is 2 V / A over the longest side: the thickness of a plate. The last row is the rank "
    "correlation (Spearman) of thickness with the ratio of CD to that of {none} [95 % interval, bootstrap "
    "over parts]: below zero means that the thin parts pay most for the term."
)


def thickness(mesh: Mesh) -> float | None:
    """2 V / A in lengths of the box's longest side; None where the mesh encloses nothing."""
    shape = topology(mesh)
    if not (shape.watertight and shape.oriented and shape.volume):
        return None
    return 2 * abs(shape.volume) / float(mesh.areas.sum()) / cube_frame(mesh).scale


def thin_parts(found: Sequence[Result], none: str, names: Sequence[str]) -> list[Table]:
    """A row a part; nothing where no truth with a thickness is there. none: who fits without the term."""
    known = {part: own for part, own in thicknesses(found).items() if own is not None}
    if not known:
        return []
    values = {name: means(found, name) for name in names}
    order = sorted(known, key=known.__getitem__)
    rows = [row(part, known[part], [values[name].get(part) for name in names]) for part in order]
    rows.append((Cell("ρ"), Cell(""), *(paid(values[name], values[none], known) for name in names)))
    title = "Thin parts: what the curvature term costs them"
    return [Table(title, CAPTION.format(none=none), ("", "thickness, %", *names), tuple(rows))]


def thicknesses(found: Sequence[Result]) -> dict[str, float | None]:
    """Of every part whose truth can still be read."""
    paths = {one.part: Path(one.fit["truth"]) for one in found}
    known: dict[str, float | None] = {}
    for part, path in paths.items():
        try:
            known[part] = thickness(read_mesh(path))
        except WeingartenError:
            known[part] = None
    return known


def row(part: str, thick: float, values: Sequence[float | None]) -> tuple[Cell, ...]:
    """A part's."""
    cells = [Cell(CHAMFER.shown(v), v, m) for v, m in zip(values, marked(values), strict=True)]
    return (Cell(part), Cell(f"{100 * thick:.1f}", thick), *cells)


def means(found: Sequence[Result], name: str) -> dict[str, float]:
    """A contender's CD by part, over the seeds."""
    figures = figures_of(found, name, CHAMFER.key)
    return {part: sum(own.values()) / len(own) for part, own in figures.items()}


def paid(own: dict[str, float], none: dict[str, float], known: dict[str, float]) -> Cell:
    """The correlation of thickness with CD over that of none, on the parts that have all three."""
    parts = [part for part in known if part in own and none.get(part)]
    ratios = np.array([own[part] / none[part] for part in parts])
    found = correlation(np.array([known[part] for part in parts]), ratios)
    if found is None:
        return Cell("")
    return Cell(f"{found.value:+.2f} [{found.low:+.2f}, {found.high:+.2f}]", found.value)

"""Figure 3 of arXiv 2511.03147: parts row by row, the truth and what each contender made of its scan.

Every mesh of a part is seen by the camera that fits the truth, in the truth's unit cube. A contender's
surface is coloured by the distance of its visible places to the triangles of the truth; one scale for the
whole figure, in 10⁻³ lengths of the cube. What of the truth a contender lacks has no place to be coloured:
the figure beneath, the Chamfer distance of the exact protocol, counts it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from weingarten.bench.metric import EXACT_METRICS
from weingarten.bench.parts import Part
from weingarten.bench.store import Entry, Store
from weingarten.errors import InputError, OptionError
from weingarten.metrics.distance import Nearby
from weingarten.metrics.unit_cube import unit_cube
from weingarten.report.camera import Camera
from weingarten.report.heat import Distances, Scale, scale_for, seen_distances
from weingarten.report.panel import Panel, cut_out, seen
from weingarten.reproduce import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PANEL = 400
"""Pixels along a picture's width."""

TRUTH = "truth"
CHAMFER = EXACT_METRICS[0]

GAP, ABOVE, BENEATH = 0.05, 0.24, 0.19
"""Inches: between pictures, for the headings, for the line beneath a row."""

INCH, LETTER, LINE = 72.0, 0.62, 1.2
"""Points of an inch; a letter's width and a line's height, in sizes of the type."""

KEY = 0.46
"""Inches at the figure's lower edge, for the scale of colours."""


@dataclass(frozen=True)
class Judged:
    """A contender's mesh of a part: what is seen of it, how far that is from the truth, and its figure."""

    panel: Panel
    distance: Distances
    chamfer: float | None


@dataclass(frozen=True)
class Row:
    """A part: what is seen of its truth, and every contender's mesh, None where there is none."""

    name: str
    truth: Panel
    judged: tuple[Judged | None, ...]

    @property
    def shape(self) -> float:
        """Height over width of its pictures."""
        return self.truth.camera.height / self.truth.camera.width


def figure_qualitative(
    folder: Path,
    parts: Sequence[Part],
    contenders: Mapping[str, str],
    seed: int = 0,
    end: float | None = None,
    panel: int = PANEL,
) -> "Figure":
    """The truths of some parts beside the meshes of a benchmark's folder, coloured by their errors.

    contenders: names in the folder, such as "odw-linear-w10", by the heading of their column. end: of the
    scale, unit-cube lengths; by default as `report.heat` chooses it. panel: pixels along a picture's width.

    Raises OptionError without parts or contenders or for a bad end, InputError where the folder has no mesh
    of a contender or a truth cannot be read, MissingExtraError without matplotlib.
    """
    if not parts or not contenders:
        raise OptionError("There is nothing to compare; name at least one part and one contender.")
    if end is not None and not 0 < end < float("inf"):
        raise OptionError(f"The end of the scale must be positive and finite; got {end}.")
    check_contenders(Store(folder), parts, list(contenders.values()), seed)
    with style.look():
        rows = [judged_row(Store(folder), part, list(contenders.values()), seed, panel) for part in parts]
        every = [one.distance for row in rows for one in row.judged if one is not None]
        scale = scale_for(1.0, every) if end is None else Scale(end)
        return _drawn(rows, [TRUTH, *contenders], scale)


def check_contenders(store: Store, parts: Sequence[Part], names: Sequence[str], seed: int) -> None:
    """Raise InputError for a contender that has no mesh of any of the parts."""
    asked = ", ".join(part.name for part in parts)
    for name in names:
        if not any(store.entry(part.name, name, seed).mesh_path.exists() for part in parts):
            raise InputError(f"{store.path} has no mesh by {name!r} with seed {seed} of {asked}.")


def judged_row(store: Store, part: Part, names: Sequence[str], seed: int, panel: int) -> Row:
    """A part's truth and its meshes, all in the truth's unit cube."""
    truth = part.mesh()
    cube = unit_cube(truth, truth)
    camera, nearest = Camera.around(cube.corners.reshape(-1, 3), panel), Nearby(cube)

    def judged(entry: Entry) -> Judged | None:
        if not entry.mesh_path.exists():
            return None
        seen_mesh = seen(unit_cube(entry.mesh(), truth), camera)
        return Judged(seen_mesh, seen_distances(seen_mesh, nearest), chamfer_of(entry))

    found = [judged(store.entry(part.name, name, seed)) for name in names]
    return Row(part.name, seen(cube, camera), tuple(found))


def chamfer_of(entry: Entry) -> float | None:
    """The Chamfer distance of the exact protocol, unit-cube lengths; None where it was not measured."""
    protocol, name = CHAMFER.key.split(".", 1)
    value = entry.figures.get(protocol, {}).get(name)
    return None if value is None else float(value)


def _drawn(rows: Sequence[Row], headings: Sequence[str], scale: Scale) -> "Figure":
    """All pictures, their lines and the scale."""
    side = (style.WIDTH + GAP) / len(headings) - GAP
    size = style.TYPE if len(headings) < 8 else style.SMALL
    letters = max(1, int(INCH * side / (LETTER * size)))
    wrapped = [fill(heading, letters, break_long_words=False) for heading in headings]
    above = ABOVE + max(text.count("\n") for text in wrapped) * LINE * size / INCH
    height = above + sum(side * row.shape + BENEATH for row in rows) + KEY
    figure = style.new_figure(height)
    for column, heading in enumerate(wrapped):
        middle = (column * (side + GAP) + side / 2) / style.WIDTH
        figure.text(middle, 1 - 0.5 * above / height, heading, ha="center", va="center", size=size)
    top = height - above
    for row in rows:
        tall = side * row.shape
        top -= tall
        for column, (image, line) in enumerate(_pictures(row, scale)):
            left = column * (side + GAP)
            axes = style.plate(figure, left, top, side, tall)
            if image is None:
                axes.text(0.5, 0.5, "no mesh", ha="center", va="center", color=style.MUTED)
            else:
                axes.imshow(np.asarray(image), aspect="auto")
            where, align = (left + side / 2, "center") if column else (0.0, "left")
            text = {"ha": align, "va": "top", "size": style.SMALL}
            figure.text(where / style.WIDTH, (top - 0.015) / height, line, **text)
        top -= BENEATH
    _add_scale(figure, scale)
    return figure


def _pictures(row: Row, scale: Scale) -> list[tuple[Image.Image | None, str]]:
    """Every picture of a row with the line beneath it."""
    made: list[tuple[Image.Image | None, str]] = [(cut_out(row.truth.shaded(), row.truth.seen), row.name)]
    for one in row.judged:
        if one is None:
            made.append((None, ""))
        else:
            image = cut_out(one.panel.coloured(scale.colours(one.distance)), one.panel.seen)
            made.append((image, "" if one.chamfer is None else f"CD {1e3 * one.chamfer:.2f}"))
    return made


def _add_scale(figure: "Figure", scale: Scale) -> None:
    """What the colours mean, in thousandths."""
    axes = style.colour_bar(figure, 0.32, Scale(1e3 * scale.end).ticks())
    axes.set_xlabel(
        r"distance to the truth's triangles (colour) and CD (numbers), $10^{-3}$ unit-cube lengths",
        labelpad=1.0,
        size=style.SMALL,
    )

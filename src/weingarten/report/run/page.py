"""The page about one fit: one HTML file that needs nothing else, neither a network nor another file.

The same folder gives the same bytes. Everything that is said is from the run folder; nothing is fitted here.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from weingarten.atomic import check_writable
from weingarten.mesh import Mesh
from weingarten.report import extra, template
from weingarten.report.facts import counted
from weingarten.report.run import facts, pictures, plots
from weingarten.report.run.colours import UNKNOWN, Colours, worded
from weingarten.report.run.deviation import Deviation
from weingarten.report.run.source import Run, read_run
from weingarten.report.run.verdict import verdict
from weingarten.report.scene import TRIANGLES


@dataclass(frozen=True)
class Made:
    """What the page is about, and how large it is."""

    steps: int
    warnings: int
    size: int

    def __str__(self) -> str:
        """For a person."""
        said = f"{counted(self.steps, 'step')}, {counted(self.warnings, 'warning')}"
        return f"{said}, {self.size / 1e6:.1f} MB"


def write_run_page(folder: Path, path: Path) -> Made:
    """Write the page about a run folder.

    Raises InputError for a folder whose files cannot be read, OutputError where the page cannot be written,
    MissingExtraError without the extra `report`.
    """
    extra.check()
    run = read_run(folder)
    check_writable(path)
    said = verdict(run)
    page = template.rendered(
        "run.html",
        title=run.name,
        verdict=said,
        run=run,
        figures=facts.figures(run.summary or {}),
        primitives=facts.primitives(run.primitives),
        settings=facts.settings(run.settings),
        origin=facts.origin(run),
        command=str(run.made.get("command") or ""),
        losses=plots.loss_plots(run.losses, run.planned),
        phases=plots.shares((run.summary or {}).get("seconds") or {}),
        triangles=TRIANGLES,
        **(without_mesh(run) if run.mesh is None else of_mesh(run, run.mesh)),
    )
    return Made(run.taken, len(said.warnings), template.write(path, page))


def without_mesh(run: Run) -> dict[str, Any]:
    """What is shown of a run that has no mesh: its points."""
    shown = {"points": pictures.points_picture(run.cloud), "mesh": None, "sides": [], "deviation": None}
    return shown | {"colours": {}, "anchors": [], "viewing": {"parts": []}, "scenes": []}


def of_mesh(run: Run, mesh: Mesh) -> dict[str, Any]:
    """What is shown of a mesh and of the points' deviations from it."""
    deviation = Deviation.of(mesh, run.cloud)
    diagonal = float((run.summary or {}).get("diagonal", 0.0))
    colours = Colours.of(deviation.value, deviation.signed, diagonal)
    drawn = pictures.drawn(mesh)
    points, shaded = pictures.pair(run.cloud, drawn)
    viewing, scenes = pictures.viewing(run.name, drawn, deviation, colours)
    return {
        "points": points,
        "mesh": shaded,
        "sides": pictures.sides(drawn, deviation, colours),
        "deviation": deviation,
        "scale": colours,
        "beyond": 100.0 * plots.counts(deviation, colours)[2] / len(deviation.value),
        "histogram": plots.histogram(deviation, colours),
        "cumulative": plots.cumulative(deviation, colours),
        "colours": {},
        "anchors": colours.anchors,
        "unknown": UNKNOWN,
        "worded": worded,
        "viewing": viewing,
        "scenes": scenes,
    }

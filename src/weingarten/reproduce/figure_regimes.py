"""Figure 1 of arXiv 2511.03147: the four regimes of curvature, and what the ODW term asks for in each.

Upper row: the regime, by the signs of κ₁ and κ₂. Lower row: the off-diagonal Weingarten residual, its mean
over tangent frames, |κ₁ − κ₂|/π. It vanishes on planes and spheres alone: a cylinder of radius r, which is
developable, keeps 1/(πr), so the term is no prior of developability. Every pixel's curvatures come from the
second derivatives of the exact field at its place on the surface; so do the numbers.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64
from PIL import Image

from weingarten.mesh import Mesh
from weingarten.report.camera import SUPERSAMPLING, Camera
from weingarten.report.extra import required
from weingarten.report.heat import Scale
from weingarten.report.panel import Panel, cut_out, seen
from weingarten.reproduce import style
from weingarten.reproduce.curvature import FLAT, REGIMES, Curvatures, Points, curvatures, on_surface
from weingarten.reproduce.specimens import REACH, SPECIMENS, Specimen
from weingarten.surface.contour import extract

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANEL = 420
"""Pixels along a picture's side."""

REGIME_COLOURS = dict(zip(REGIMES, (style.GREY, style.SKY, style.GREEN, style.VERMILION), strict=True))
SIGNS = {
    "planar": r"$\kappa_1=\kappa_2=0$",
    "parabolic": "one is 0",
    "elliptic": "same sign",
    "hyperbolic": "opposite signs",
}
END = 1.0
"""Of the colour scale of the residual, one over unit length."""

BAR = (
    r"ODW residual, mean over tangent frames, $|\kappa_1-\kappa_2|/\pi$: "
    "zero on planes and spheres, not on cylinders and cones"
)
SYMBOLS = (
    r"$\kappa$ and ODW per unit length; $r$: radius of the cylinder or tube, $R$: of the ring, "
    r"$\rho$: distance from the axis, $\alpha$: half angle"
)
MARKS = (("white", style.INK, "○"), (style.INK, "white", "●"))
"""Fill, rim and sign in the text of a first and a second mark."""

HEIGHT = 3.57
MARGIN, SIDE, GAP = 0.42, 0.94, 0.035
"""Inches: left of the pictures, their side, between them."""

UPPER, LOWER, LINE = 2.20, 0.93, 0.125
"""Inches from the figure's lower edge to that of each row of pictures; from line to line of type."""


@dataclass(frozen=True)
class View:
    """A specimen as it is drawn: both pictures, and its marks in pixels and with their curvatures."""

    specimen: Specimen
    regimes: Image.Image
    residuals: Image.Image
    marks: Float64[np.ndarray, "m 2"]
    at_marks: Curvatures


def figure_regimes(panel: int = PANEL) -> "Figure":
    """Exact surfaces coloured by regime and by the averaged ODW residual, with κ₁, κ₂ read at marked places.

    panel: pixels along a picture's side. Raises MissingExtraError without matplotlib.
    """
    with style.look():
        figure = style.new_figure(HEIGHT)
        for column, view in enumerate(regime_views(panel)):
            left = MARGIN + column * (SIDE + GAP)
            upper = style.plate(figure, left, UPPER, SIDE, SIDE)
            lower = style.plate(figure, left, LOWER, SIDE, SIDE)
            _show(upper, view.regimes, view, panel)
            _show(lower, view.residuals, view, panel)
            upper.set_title(view.specimen.name, pad=1.0)
            _write(upper, curvatures_in_words(view))
            _write(lower, residuals_in_words(view))
        _head(figure, UPPER, "regime", r"$\kappa_1,\ \kappa_2$")
        _head(figure, LOWER, "ODW residual", "ODW")
        _add_keys(figure)
    return figure


def regime_views(panel: int = PANEL) -> list[View]:
    """All specimens, at one scale."""
    resolution = max(32, 3 * panel // 10)
    corner = np.array([[-REACH] * 3, [REACH] * 3])
    meshes = [extract(specimen.shape, corner[0], corner[1], resolution) for specimen in SPECIMENS]
    whole = Camera.around(np.concatenate([mesh.vertices for mesh in meshes]), panel)
    camera = replace(whole, height=whole.width, centre=np.zeros(3))
    return [view(specimen, mesh, camera) for specimen, mesh in zip(SPECIMENS, meshes, strict=True)]


def view(specimen: Specimen, mesh: Mesh, camera: Camera) -> View:
    """Normals and colours of every pixel from the exact field."""
    rough = seen(mesh, camera)
    here = curvatures(specimen.shape, on_surface(specimen.shape, rough.positions))
    normals = np.zeros_like(rough.normals)
    normals[rough.seen] = here.normals @ camera.axes.T
    fine = replace(rough, normals=normals)
    paints = np.array([_rgb(REGIME_COLOURS[name]) for name in REGIMES])
    places = marked_places(specimen)
    return View(
        specimen,
        _picture(fine, paints[here.regime]),
        _picture(fine, Scale(END).colours(here.residual)),
        camera.to_screen(places)[:, :2] / SUPERSAMPLING,
        curvatures(specimen.shape, places),
    )


def marked_places(specimen: Specimen) -> Points:
    """The specimen's marks, on its surface."""
    return on_surface(specimen.shape, np.array([mark.place for mark in specimen.marks], dtype=np.float64))


def _picture(panel: Panel, colours: Float64[np.ndarray, "n 3"]) -> Image.Image:
    return cut_out(panel.coloured(colours), panel.seen)


def _rgb(code: str) -> tuple[float, float, float]:
    red, green, blue = (int(code[at : at + 2], 16) / 255 for at in (1, 3, 5))
    return red, green, blue


def _show(axes: "Axes", image: Image.Image, view: View, panel: int) -> None:
    """A picture and its marks."""
    axes.imshow(np.asarray(image), extent=(0, panel, panel, 0))
    for place, (fill, rim, _) in zip(view.marks, MARKS, strict=False):
        axes.plot(*place, "o", ms=3.4, color=fill, mec=rim, mew=0.7)
    axes.set(xlim=(0, panel), ylim=(panel, 0))


def _write(axes: "Axes", lines: list[str]) -> None:
    """A line for every mark, beneath the picture, after the mark's own sign where there are several."""
    for index, (line, (_, _, sign)) in enumerate(zip(lines, MARKS, strict=False)):
        text = f"{sign} {line}" if len(lines) > 1 else line
        height = -0.01 - LINE * index / SIDE
        axes.text(0.5, height, text, transform=axes.transAxes, ha="center", va="top", size=style.SMALL)


def curvatures_in_words(view: View) -> list[str]:
    """κ₁, κ₂ at every mark."""
    read = zip(view.at_marks.first, view.at_marks.second, strict=True)
    return [rf"${number(first)},\ {number(second)}$" for first, second in read]


def residuals_in_words(view: View) -> list[str]:
    """The averaged ODW residual at every mark, as a formula and as a number."""
    read = zip(view.specimen.marks, view.at_marks.residual, strict=True)
    return ["$0$" if mark.formula == "0" else rf"${mark.formula}={number(own)}$" for mark, own in read]


def number(value: float) -> str:
    """Two digits after the point; a plain 0 for what is zero but for rounding."""
    return "0" if abs(value) < FLAT else f"{{{value:.2f}}}"


def _head(figure: "Figure", bottom: float, picture: str, line: str) -> None:
    """What a row of pictures and the numbers beneath it are, in the margin."""
    whole = figure.get_figheight()
    figure.text(
        0.11 / style.WIDTH, (bottom + SIDE / 2) / whole, picture, rotation=90, ha="center", va="center"
    )
    figure.text(0.03 / style.WIDTH, (bottom - 0.01) / whole, line, ha="left", va="top", size=style.SMALL)


def _add_keys(figure: "Figure") -> None:
    """What the colours mean: regimes above, residuals beneath."""
    patch = required("matplotlib.patches").Patch
    keys = [patch(color=REGIME_COLOURS[name], label=f"{name}: {SIGNS[name]}") for name in REGIMES]
    figure.legend(handles=keys, loc="upper center", ncols=4, handlelength=1.0, columnspacing=1.6)
    ticks = [(0.0, "0"), (1 / np.pi / END, r"$1/\pi$"), (1.0, f"≥ {END:g}")]
    axes = style.colour_bar(figure, 0.45, ticks)
    axes.set_xlabel(f"{BAR}\n{SYMBOLS}", labelpad=1.0, size=style.SMALL, linespacing=1.4)

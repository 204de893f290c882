"""Figures as files: the same figure is the same bytes, whenever and by whomever it is written."""

from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.atomic import replacing
from weingarten.reproduce.style import look

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS = {"png": 200, "svg": 300}
"""An inch of each format; of an SVG's only pictures within it."""

SILENCE = {"png": {"Software": None}, "svg": {"Date": None, "Creator": None}}
"""What would change from day to day and from version to version."""


def write_figure(figure: "Figure", path_without_suffix: Path) -> tuple[Path, Path]:
    """Write PATH.png and PATH.svg, each whole or not at all; their paths. Raises OutputError.

    Type in the SVG is drawn as outlines, so that it looks alike everywhere.
    """
    with look():
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        FigureCanvasAgg(figure)
        png, svg = (_write(figure, path_without_suffix, form) for form in DOTS)
    return png, svg


def _write(figure: "Figure", path_without_suffix: Path, form: str) -> Path:
    path = path_without_suffix.with_name(f"{path_without_suffix.name}.{form}")
    with replacing(path) as temporary:
        figure.savefig(temporary, format=form, dpi=DOTS[form], metadata=SILENCE[form])
    return path

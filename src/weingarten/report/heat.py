"""Distances as colours: one colour map for pictures and for the view in 3D, one scale for all of a part."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64, UInt8

from weingarten.metrics.distance import Nearby
from weingarten.report.camera import SUPERSAMPLING
from weingarten.report.panel import Panel

Distances = Float64[np.ndarray, " _"]
Colours = Float64[np.ndarray, "_ 3"]

ANCHORS = ("#e6edf3", "#cfe3dc", "#f3dc7a", "#f2a541", "#e2603a", "#b3204d", "#5a1164")
"""From nothing to the end of the scale and beyond, evenly spaced: ever darker, for all kinds of eyes."""

LEVELS = 256
PERCENTILE = 99.0
NARROWEST, WIDEST = 1e-3, 2e-2
"""Ends of scales, in lengths of the part's longest side."""
STEPS = (1.0, 2.0, 5.0)
TICKS = 4


@dataclass(frozen=True)
class Scale:
    """Colours of distances from 0 to `end`, in the unit of the input; what is farther has the last one."""

    end: float

    def colours(self, distance: Distances) -> Colours:
        """Display colours, each channel 0 to 1."""
        return colour_map()[np.round(self.places(distance)).astype(np.int64)] / 255.0

    def places(self, distance: Distances) -> Distances:
        """Places on the colour map, 0 to 255."""
        return np.clip(distance / self.end, 0.0, 1.0) * (LEVELS - 1)

    @property
    def unit(self) -> str:
        """The unit of the ticks, in words."""
        return f"in {power(self.end)}the unit of the file"

    @property
    def said(self) -> str:
        """The scale for those who hear it."""
        return f"Colours of distances from 0 to {self.end} and more"

    def ticks(self) -> list[tuple[float, str]]:
        """Where a tick stands, from 0 to 1, and what it says, in `unit`; the last one says "or more"."""
        values = [self.end / 10.0 ** exponent(self.end) * k / TICKS for k in range(TICKS + 1)]
        texts = [f"{value:.3g}" for value in values]
        return [(k / TICKS, text) for k, text in enumerate([*texts[:-1], f"≥ {texts[-1]}"])]


def exponent(length: float) -> int:
    """Of the power of ten that it is shown in: a multiple of three, 0 for lengths of common size."""
    return 0 if 0.01 <= length < 10_000 else 3 * int(np.floor(np.log10(length) / 3))


def power(length: float) -> str:
    """That power in words, "10⁻³ of ", or nothing where it is one."""
    digits = str(exponent(length)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return "" if exponent(length) == 0 else f"10{digits} of "


def colour_map(codes: Sequence[str] = ANCHORS) -> UInt8[np.ndarray, "256 3"]:
    """Colours, linear in between."""
    anchors = np.array([[int(code[i : i + 2], 16) for i in (1, 3, 5)] for code in codes], dtype=np.float64)
    place = np.linspace(0, len(anchors) - 1, LEVELS)
    channels = [np.interp(place, np.arange(len(anchors)), anchors[:, k]) for k in range(3)]
    return np.round(np.stack(channels, axis=1)).astype(np.uint8)


def scale_for(side: float, distances: Sequence[Distances]) -> Scale:
    """The scale of a part whose longest side is `side`; one set of distances a contender.

    Its end is 1, 2 or 5 times a power of ten: the least one that takes in 99 % of the distances of the
    contender in the middle (the lower median), within about 0.1 % and 2 % of the longest side.
    """
    ends = sorted(float(np.percentile(own, PERCENTILE)) for own in distances if len(own))
    middle = ends[(len(ends) - 1) // 2] if ends else 0.0
    return Scale(rounded_up(min(max(middle, NARROWEST * side), WIDEST * side)))


def rounded_up(value: float) -> float:
    """To 1, 2 or 5 times a power of ten."""
    decade = 10.0 ** np.floor(np.log10(value))
    nice = next((step for step in STEPS if value <= step * decade * (1 + 1e-9)), 10.0)
    return float(f"{nice * decade:.6g}")


def seen_distances(panel: Panel, other: Nearby) -> Distances:
    """Distance of every seen place to the triangles of another mesh, in their unit.

    One place is measured in every block of supersampled pixels and stands for the block.
    """
    places, which = seen_places(panel)
    return other.closest(places).distance[which]


def seen_places(panel: Panel) -> tuple[Float64[np.ndarray, "m 3"], Int64[np.ndarray, " n"]]:
    """One seen place of every block of supersampled pixels, and every seen pixel’s number of its block."""
    rows, columns = np.nonzero(panel.seen)
    block = (rows // SUPERSAMPLING) * panel.seen.shape[1] + columns // SUPERSAMPLING
    _, first, which = np.unique(block, return_index=True, return_inverse=True)
    return panel.positions[first], which

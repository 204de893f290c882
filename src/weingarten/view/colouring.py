"""What colours a mesh: values at its vertices, and a scale that gives them places on a colour map."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64, UInt8
from scipy.spatial import KDTree

from weingarten.mesh import Mesh
from weingarten.metrics.confidence import confidence
from weingarten.metrics.distance import closest
from weingarten.report.heat import ANCHORS, LEVELS, colour_map, rounded_up
from weingarten.view.display import few
from weingarten.world_field import WorldField

Points = Float64[np.ndarray, "_ 3"]
Values = Float64[np.ndarray, " _"]

SIGNED = ("#1f4f96", "#5c95cd", "#b9d5ea", "#ececea", "#f6c9a6", "#df7f52", "#a3281f")
"""From below zero to above, pale at zero."""

MAPS = {"heat": ANCHORS, "trust": (*ANCHORS[:0:-1], "#dfe9e3"), "signed": SIGNED}
ASKED, AROUND = 100_000, 6
"""Points whose distance from a mesh is measured; how many of them a vertex has the mean of."""

SMALLEST = float(np.finfo(np.float32).tiny)
MOST, MOST_SIGNED = 99.0, 80.0
"""Per cent of the area that scales take in. Of curvatures the rest is on edges, where they have no end."""


@dataclass(frozen=True)
class Scale:
    """low, high: values at the ends of a colour map. open_low, open_high: whether there are values beyond."""

    colours: str
    low: float
    high: float
    open_low: bool
    open_high: bool

    def places(self, values: Values) -> UInt8[np.ndarray, " _"]:
        """On the colour map, from 0 to 255; what is not finite has the last one."""
        part = (np.nan_to_num(values, nan=self.high) - self.low) / (self.high - self.low)
        return np.round(np.clip(part, 0.0, 1.0) * (LEVELS - 1)).astype(np.uint8)

    def ticks(self) -> list[tuple[float, str]]:
        """Where a tick stands, from 0 to 1, and what it says."""
        texts = [f"{self.low + (self.high - self.low) * k / 4:.3g}".replace("-", "−") for k in range(5)]
        texts[0] = f"≤ {texts[0]}" if self.open_low else texts[0]
        texts[-1] = f"≥ {texts[-1]}" if self.open_high else texts[-1]
        return [(k / 4, text) for k, text in enumerate(texts)]


def from_zero(values: Values, areas: Values) -> Scale:
    """From 0 to 1, 2 or 5 times a power of ten. areas: of the surface that a value is of."""
    return Scale("heat", 0.0, rounded_up(max(within(values, areas, MOST), SMALLEST)), False, True)


def about_zero(values: Values, areas: Values) -> Scale:
    """The same, and as far below zero."""
    end = rounded_up(max(within(np.abs(values), areas, MOST_SIGNED), SMALLEST))
    return Scale("signed", -end, end, True, True)


def as_trust(values: Values, areas: Values) -> Scale:
    """From 0 to 1."""
    return Scale("trust", 0.0, 1.0, False, False)


def within(values: Values, areas: Values, percent: float) -> float:
    """What so many per cent of the area do not exceed; values that are not finite do not count."""
    known = np.isfinite(values)
    if not known.any():
        return 0.0
    order = np.argsort(values[known])
    share = np.cumsum(areas[known][order])
    place = np.searchsorted(share, share[-1] * percent / 100.0)
    return float(values[known][order][min(int(place), len(order) - 1)])


@dataclass
class Material:
    """What is known of a mesh as it is drawn, world frame.

    whole: the mesh that it stands for. noise: of the points, in their unit.
    """

    mesh: Mesh
    whole: Mesh
    points: Points | None
    noise: float
    field: WorldField | None

    @cached_property
    def areas(self) -> Values:
        """Of the surface about every vertex: a third of that of its faces."""
        each = np.repeat(self.mesh.areas / 3.0, 3)
        return np.bincount(self.mesh.faces.reshape(-1), weights=each, minlength=len(self.mesh.vertices))

    @cached_property
    def gap(self) -> Values:
        """From every vertex to the nearest point."""
        assert self.points is not None
        return np.asarray(KDTree(self.points).query(self.mesh.vertices, workers=-1)[0])

    @cached_property
    def misses(self) -> Values:
        """How far points are from the mesh: at every vertex the mean of those AROUND it that are nearest."""
        assert self.points is not None
        asked = few(self.points, ASKED)
        off = closest(self.whole, asked).distance
        nearest = KDTree(asked).query(self.mesh.vertices, k=min(AROUND, len(asked)), workers=-1)[1]
        return off[np.reshape(nearest, (len(self.mesh.vertices), -1))].mean(axis=1)

    @cached_property
    def trust(self) -> Values:
        """Confidence of every vertex."""
        assert self.points is not None
        return confidence(self.mesh.vertices, self.points, self.noise)

    @cached_property
    def curvatures(self) -> Float64[np.ndarray, "_ 2"]:
        """κ₁ ≤ κ₂ of the field at every vertex."""
        assert self.field is not None
        return self.field(self.mesh.vertices).curvatures


@dataclass(frozen=True)
class Colouring:
    """title, unit: for people. needs: what of a Material it is made of, by name."""

    key: str
    title: str
    unit: str
    needs: str
    values: Callable[[Material], Values]
    scale: Callable[[Values, Values], Scale]


LENGTH, BEND, GAUSS = "in the cloud's unit", "one over the cloud's unit", "one over the cloud's unit, squared"
BESIDE = "how far the points around are from the mesh, in the cloud's unit"
SHARE = "1 where points bear the surface out, 0 where it is a guess"


def gap(own: Material) -> Values:
    """Distance to the nearest point."""
    return own.gap


def misses(own: Material) -> Values:
    """Distance of the points from the mesh."""
    return own.misses


def trust(own: Material) -> Values:
    """Confidence."""
    return own.trust


def mean(own: Material) -> Values:
    """½ (κ₁ + κ₂)."""
    return own.curvatures.mean(axis=1)


def gaussian(own: Material) -> Values:
    """κ₁ κ₂."""
    return own.curvatures.prod(axis=1)


def lesser(own: Material) -> Values:
    """κ₁."""
    return own.curvatures[:, 0]


def greater(own: Material) -> Values:
    """κ₂."""
    return own.curvatures[:, 1]


COLOURINGS: Sequence[Colouring] = (
    Colouring("distance", "Distance to the points", BESIDE, "points", misses, from_zero),
    Colouring("gap", "Distance to the nearest point", LENGTH, "points", gap, from_zero),
    Colouring("confidence", "Confidence", SHARE, "points", trust, as_trust),
    Colouring("mean", "Mean curvature", BEND, "field", mean, about_zero),
    Colouring("gaussian", "Gaussian curvature", GAUSS, "field", gaussian, about_zero),
    Colouring("lesser", "Curvature κ₁, the lesser", BEND, "field", lesser, about_zero),
    Colouring("greater", "Curvature κ₂, the greater", BEND, "field", greater, about_zero),
)


def maps() -> dict[str, list[int]]:
    """256 colours each, three bytes a colour."""
    return {name: colour_map(anchors).reshape(-1).tolist() for name, anchors in MAPS.items()}

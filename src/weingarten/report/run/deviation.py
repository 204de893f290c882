"""How far the points of a cloud are from a mesh, with a sign where the mesh has an inside.

    d(p) = ± min ‖p − q‖ over the triangles, + outside of the mesh, − inside of it

so where d > 0 the mesh lies below the points: material is missing. A mesh that is not closed has no inside;
d is the plain distance then.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.metrics.confidence import confidence
from weingarten.metrics.distance import closest, inside
from weingarten.metrics.topology import topology
from weingarten.scan.noise import noise_level
from weingarten.summary import probe

Points = Float64[np.ndarray, "n 3"]
Values = Float64[np.ndarray, " n"]

SHARES = (50.0, 90.0, 95.0, 99.0, 99.9)
"""Of the points, per cent: how near to the mesh these are is said."""


@dataclass(frozen=True)
class Deviation:
    """points: those that are measured, all or evenly picked. foot: the place on the mesh nearest to each.

    value: d of each, in the cloud's unit. signed: whether it has a sign.
    """

    points: Points
    foot: Points
    value: Values
    signed: bool

    @classmethod
    def of(cls, mesh: Mesh, cloud: Points) -> "Deviation":
        """From a cloud and a mesh with a surface, in one frame. Raises InputError for one without."""
        points = probe(cloud)
        found = closest(mesh, points)
        if not topology(mesh).watertight:
            return cls(points, found.position, found.distance, signed=False)
        sign = np.where(inside(mesh, points), -1.0, 1.0)
        return cls(points, found.position, sign * found.distance, signed=True)

    @property
    def distance(self) -> Values:
        """|d|."""
        return np.abs(self.value)

    @property
    def mean(self) -> float:
        """Of d."""
        return float(self.value.mean())

    @property
    def spread(self) -> float:
        """Standard deviation of d."""
        return float(self.value.std())

    @property
    def worst(self) -> float:
        """The d that is farthest from 0."""
        return float(self.value[self.distance.argmax()])

    @property
    def within(self) -> list[tuple[float, float]]:
        """Shares of the points in per cent, and the distance of the mesh that they are within."""
        return [(share, float(np.percentile(self.distance, share))) for share in SHARES]

    @cached_property
    def _feet(self) -> KDTree:
        return KDTree(self.foot)

    @cached_property
    def _noise(self) -> float:
        frame = Frame.of(self.points)
        unit = frame.to_unit(self.points)
        return noise_level(unit, KDTree(unit)) * frame.scale

    def at(self, places: Float64[np.ndarray, "m 3"]) -> Float64[np.ndarray, " m"]:
        """d of the point whose foot is nearest to each place on the mesh; NaN far from all points."""
        if not len(places):
            return np.zeros(0)
        nearest = np.asarray(self._feet.query(places, workers=-1)[1])
        return np.where(confidence(places, self.points, self._noise) == 0.0, np.nan, self.value[nearest])

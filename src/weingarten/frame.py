"""World ↔ unit: the only place where scale and offset live, always in float64.

World frame: the input's own coordinates and unit. Unit frame: points minus their mean, divided by the
largest absolute coordinate, so that the cloud touches the cube [-1, 1]³.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

Points = Float64[np.ndarray, "n 3"]


@dataclass(frozen=True)
class Frame:
    """x_unit = (x_world − centre) / scale. Lengths scale by 1/scale, curvatures by scale."""

    centre: tuple[float, float, float]
    scale: float

    @classmethod
    def of(cls, points: Points) -> "Frame":
        """The frame of a cloud in world units: its mean and its largest absolute centred coordinate.

        Rounding keeps order, so the corners of the box alone tell the second, to the last bit.
        """
        centre = points.mean(axis=0)
        scale = float(np.maximum(points.max(axis=0) - centre, centre - points.min(axis=0)).max())
        return cls((float(centre[0]), float(centre[1]), float(centre[2])), scale)

    def to_unit(self, points: Points) -> Points:
        """World positions to unit positions."""
        return (points - np.asarray(self.centre)) / self.scale

    def to_world(self, points: Points) -> Points:
        """Unit positions to world positions."""
        return points * self.scale + np.asarray(self.centre)

"""The camera of every picture: parallel projection, as in an engineering drawing.

View frame: x right, y up, z towards the viewer. Screen frame: x right, y down, z towards the viewer, in
supersampled pixels.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

Points = Float64[np.ndarray, "n 3"]

MARGIN = 0.06
SUPERSAMPLING = 2
AZIMUTH, ELEVATION = np.radians(-58.0), np.radians(30.0)


@dataclass(frozen=True)
class Camera:
    """A three-quarter view: screen pixel = axes · (p − centre) × scale, y turned down, plus half the panel.

    width, height: of the panel, in supersampled pixels.
    """

    axes: Float64[np.ndarray, "3 3"]
    centre: Float64[np.ndarray, " 3"]
    scale: float
    width: int
    height: int

    @classmethod
    def around(
        cls, points: Points, panel: int, azimuth: float = AZIMUTH, elevation: float = ELEVATION
    ) -> "Camera":
        """The camera that fits all points into a panel of that width, the lower the flatter they look.

        azimuth, elevation: of the viewer, radians.
        """
        size = panel * SUPERSAMPLING
        back = np.array(
            [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
        )
        right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        axes = np.stack([right, np.cross(back, right), back])
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        view = (points - middle) @ axes.T
        low, high = view.min(axis=0), view.max(axis=0)
        across, up = (high - low)[:2]
        extent = float(max(across, up))
        scale = size * (1 - 2 * MARGIN) / extent if extent > 0 else 1.0
        filled = int(np.ceil((scale * up + 2 * MARGIN * size) / SUPERSAMPLING)) * SUPERSAMPLING
        height = min(size, max(filled, size // 3))
        return cls(axes, middle + axes.T @ ((low + high) / 2), scale, size, height)

    def to_screen(self, points: Float64[np.ndarray, "*any 3"]) -> Float64[np.ndarray, "*any 3"]:
        """World positions to pixels right and down, and depth towards the viewer in pixels."""
        view = (points - self.centre) @ self.axes.T * (self.scale * np.array([1.0, -1.0, 1.0]))
        return view + np.array([self.width / 2, self.height / 2, 0.0])

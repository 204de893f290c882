"""The triangle mesh that every part of the house hands on."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64


@dataclass(frozen=True)
class Mesh:
    """An indexed triangle mesh; counter-clockwise faces seen from outside.

    vertices: positions, float64, in whichever frame the maker states (files: the world frame).
    faces: three vertex indices a triangle.
    confidence: from 0 to 1, how far the points of a fit bear each vertex out; None of other meshes.
    """

    vertices: Float64[np.ndarray, "v 3"]
    faces: Int64[np.ndarray, "f 3"]
    confidence: Float64[np.ndarray, " v"] | None = None

    @property
    def corners(self) -> Float64[np.ndarray, "f 3 3"]:
        """The three corner positions of every face."""
        return self.vertices[self.faces]

    @property
    def cross(self) -> Float64[np.ndarray, "f 3"]:
        """(b − a) × (c − a) of every face: the normal times twice the area."""
        a, b, c = self.corners.transpose(1, 0, 2)
        return np.cross(b - a, c - a)

    @property
    def areas(self) -> Float64[np.ndarray, " f"]:
        """Area of every face."""
        return 0.5 * np.linalg.norm(self.cross, axis=1)

    @property
    def bounds(self) -> Float64[np.ndarray, "2 3"]:
        """Lowest and highest corner of the axis-aligned bounding box."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

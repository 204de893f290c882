"""The nearest places of a mesh, asked for many times: `metrics.distance.closest` with a tree that is kept."""

import igl
import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.mesh import Mesh

Points = Float64[np.ndarray, "n 3"]


class Nearest:
    """A mesh with a surface, world frame; the tree sees it in its own unit frame."""

    def __init__(self, mesh: Mesh) -> None:
        self.frame = Frame.of(mesh.vertices)
        solid = mesh.faces[mesh.areas > 0]
        self.vertices = np.ascontiguousarray(self.frame.to_unit(mesh.vertices))
        self.faces = np.ascontiguousarray(solid, dtype=np.int64)
        self.tree = igl.AABB()
        self.tree.init(self.vertices, self.faces)

    def distance(self, points: Points) -> Float64[np.ndarray, " n"]:
        """Of every point to the triangles, world unit."""
        queries = np.ascontiguousarray(self.frame.to_unit(points))
        return np.linalg.norm(queries - self._places(queries), axis=1) * self.frame.scale

    def place(self, points: Points) -> Points:
        """The nearest place on the triangles, world frame."""
        return self.frame.to_world(self._places(np.ascontiguousarray(self.frame.to_unit(points))))

    def _places(self, queries: Points) -> Points:
        if not len(queries):
            return queries
        _, _, places = self.tree.squared_distance(self.vertices, self.faces, queries)
        return np.asarray(places).reshape(-1, 3)

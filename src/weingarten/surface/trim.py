"""Removal of surface far from all points: an open mesh of what was scanned, instead of a closed guess."""

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from weingarten.errors import ExtractionError
from weingarten.mesh import Mesh


def trimmed(mesh: Mesh, points: Float64[np.ndarray, "n 3"], distance: float) -> Mesh:
    """The faces of which every vertex is within a distance of some point; all in one frame.

    Vertices that no face needs any more are dropped. Raises ExtractionError where nothing is left.
    """
    gap, _ = KDTree(points).query(mesh.vertices, distance_upper_bound=distance, workers=-1)
    faces = mesh.faces[np.isfinite(gap)[mesh.faces].all(axis=1)]
    if len(faces) == 0:
        raise ExtractionError(
            "Nothing is left: no face is within --trim-distance of the points; give a greater one."
        )
    used, numbered = np.unique(faces, return_inverse=True)
    return Mesh(mesh.vertices[used], numbered.reshape(-1, 3).astype(np.int64))

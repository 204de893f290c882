"""Meshes with fewer triangles, for pictures and for the view in 3D; never for figures."""

import numpy as np

from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.report.extra import required

AGGRESSIVENESS = (4, 7)
"""How fast the allowed error grows: slowly at first, which keeps the shape far better; faster where that
does not lead to few triangles."""


def simplified(mesh: Mesh, most: int) -> Mesh:
    """About `most` triangles by quadric edge collapse (Garland and Heckbert 1997); a smaller mesh as it is.

    World frame. Raises MissingExtraError without the extra `report`.
    """
    if len(mesh.faces) <= most:
        return mesh
    frame = Frame.of(mesh.vertices)
    vertices, faces = frame.to_unit(mesh.vertices).astype(np.float32), mesh.faces.astype(np.int32)
    collapse = required("fast_simplification").simplify
    for aggressiveness in AGGRESSIVENESS:
        if len(faces) > 1.05 * most:
            vertices, faces = collapse(vertices, faces, target_count=most, agg=aggressiveness)
    world = frame.to_world(np.asarray(vertices, dtype=np.float64))
    return Mesh(world, np.asarray(faces, dtype=np.int64))

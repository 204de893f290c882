"""Exact distance from points to the triangles of a mesh, not to samples of it."""

from dataclasses import dataclass

import igl
import numpy as np
from jaxtyping import Float64, Int64

from weingarten.errors import InputError
from weingarten.mesh import Mesh

Points = Float64[np.ndarray, "n 3"]


@dataclass(frozen=True)
class Closest:
    """The nearest surface point of every query.

    distance: Euclidean, unsigned, in the mesh's unit.
    face: index of the face that the nearest point lies on; any one of them on a shared edge.
    position: the nearest point, in the mesh's frame.
    """

    distance: Float64[np.ndarray, " n"]
    face: Int64[np.ndarray, " n"]
    position: Points


def closest(mesh: Mesh, points: Points) -> Closest:
    """min over triangles T of ‖p − q‖, q ∈ T, for every point p, in the frame of both.

    The tree (libigl's AABB) sees coordinates centred on the mesh's box and divided by its longest side:
    neither an offset of 1e6 nor a size of 1e-5 costs digits beyond those of the input. Faces without area
    are left out, for they have no normal; every point of them lies on a neighbour in a closed mesh.

    Raises InputError when no face has an area.
    """
    solid = np.flatnonzero(mesh.areas > 0)
    if not len(solid):
        raise InputError("The mesh has no surface to measure to: it has no faces, or none with an area.")
    used, faces = np.unique(mesh.faces[solid], return_inverse=True)
    vertices = mesh.vertices[used]
    lowest, highest = vertices.min(axis=0), vertices.max(axis=0)
    centre, scale = (lowest + highest) / 2, float((highest - lowest).max())
    queries = (points - centre) / scale
    _, nearest, position = igl.point_mesh_squared_distance(
        np.ascontiguousarray(queries),
        np.ascontiguousarray((vertices - centre) / scale),
        np.ascontiguousarray(faces.reshape(-1, 3), dtype=np.int64),
    )
    distance = np.linalg.norm(queries - position, axis=1) * scale
    return Closest(distance, solid[np.asarray(nearest)], np.asarray(position) * scale + centre)

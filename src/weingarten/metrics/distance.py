"""Exact distance from points to the triangles of a mesh, not to samples of it."""

from dataclasses import dataclass

import igl
import numpy as np
from jaxtyping import Bool, Float64, Int64

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


class Nearby:
    """The faces of a mesh in a tree (libigl's AABB), for questions about what is nearest.

    It sees coordinates centred on the mesh's box and divided by its longest side: neither an offset of 1e6
    nor a size of 1e-5 costs digits beyond those of the input. Faces without area are left out, for they have
    no normal; every point of them lies on a neighbour in a closed mesh.

    Raises InputError when no face has an area.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.solid = np.flatnonzero(mesh.areas > 0)
        if not len(self.solid):
            raise InputError("The mesh has no surface to measure to: it has no faces, or none with an area.")
        used, faces = np.unique(mesh.faces[self.solid], return_inverse=True)
        vertices = mesh.vertices[used]
        lowest, highest = vertices.min(axis=0), vertices.max(axis=0)
        self.centre, self.scale = (lowest + highest) / 2, float((highest - lowest).max())
        self.vertices = np.ascontiguousarray((vertices - self.centre) / self.scale)
        self.faces = np.ascontiguousarray(faces.reshape(-1, 3), dtype=np.int64)
        self.tree = igl.AABB()
        self.tree.init(self.vertices, self.faces)

    def closest(self, points: Points) -> Closest:
        """min over triangles T of ‖p − q‖, q ∈ T, for every point p, in the frame of both."""
        if not len(points):
            return Closest(np.empty(0), np.empty(0, dtype=np.int64), points)
        queries = np.ascontiguousarray((points - self.centre) / self.scale)
        _, nearest, places = self.tree.squared_distance(self.vertices, self.faces, queries)
        position = np.asarray(places).reshape(-1, 3)
        distance = np.linalg.norm(queries - position, axis=1) * self.scale
        face = self.solid[np.asarray(nearest).reshape(-1)]
        return Closest(distance, face, position * self.scale + self.centre)


def closest(mesh: Mesh, points: Points) -> Closest:
    """Of every point of one mesh's frame; see Nearby."""
    return Nearby(mesh).closest(points)


def inside(mesh: Mesh, points: Points) -> Bool[np.ndarray, " n"]:
    """Whether the mesh winds about a point: |w| > ½, with w the winding number of the mesh about it.

    |w| is 1 within a closed, consistently oriented surface, whichever way its faces are turned, and 0
    outside; the far field of the tree (Barill et al. 2018, by libigl) is good to a few hundredths.
    """
    winding = igl.fast_winding_number(
        np.ascontiguousarray(mesh.vertices),
        np.ascontiguousarray(mesh.faces, dtype=np.int64),
        np.ascontiguousarray(points),
    )
    return np.abs(winding) > 0.5


def cut(mesh: Mesh, longest: float) -> Mesh:
    """The same surface as loose triangles whose edges are at most `longest`, in the mesh's unit.

    Faces are halved at the middle of their longest edge until they are so short. The long thin ones of CAD
    meshes, of which each lies in the boxes of many others, make the trees of `closest` and `inside` slow:
    of a mesh that is cut both answer the same, up to rounding and the numbers of faces, at twice the speed.
    """
    rest, short = mesh.corners, []
    while len(rest):
        lengths = np.linalg.norm(np.roll(rest, -1, axis=1) - rest, axis=2)
        short.append(rest[lengths.max(axis=1) <= longest])
        rest, lengths = (part[lengths.max(axis=1) > longest] for part in (rest, lengths))
        row, start = np.arange(len(rest)), lengths.argmax(axis=1)
        a, b, c = (rest[row, (start + k) % 3] for k in range(3))
        middle = (a + b) / 2
        rest = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    vertices = np.concatenate([*short, np.empty((0, 3, 3))]).reshape(-1, 3)
    return Mesh(vertices, np.arange(len(vertices)).reshape(-1, 3))

"""No vertex outside of the flat faces that bound the cloud: overall dimensions are those of the points.

A fitted field swings beyond an edge by some tenths of a per cent of the part, and the corners of its surface
stand out. Where the part is bounded by a flat face, points on it say where it ends: it is a facet of the
cloud's convex hull. A vertex outside of such a facet's plane, or of the bounding box, is put onto it.

Facets that differ by less than ALIKE count as one, of direction n. The plane is not at the outermost point,
but beyond it by as much as the EIGHTH outermost is before it: not at all on a flat face, as far as chance
lets the surface reach on a sphere, an edge or a tip, and by half a standard deviation, say, of noise. What
spans a hollow, or a hole in the scan, is no facet: none of the cloud is near its middle.
"""

import numpy as np
from jaxtyping import Bool, Float64
from scipy.spatial import ConvexHull, KDTree, QhullError

from weingarten.mesh import Mesh

Points = Float64[np.ndarray, "n 3"]

ALIKE = 0.9994
"""Cosine of two degrees."""

LEAST_AREA, MOST_FACES = 0.002, 64
"""Share of the hull's area that a face must have; how many are looked at, the largest first."""

SPAN = 4.0
"""Distances to the EIGHTH nearest point, in the median, within which a facet's middle has one."""

EIGHTH = 8
"""Which of the outermost points tells how far the surface may reach beyond the first."""

ASKED = 1000
"""Points that tell how far apart they are."""

ROUNDS = 4
"""Of putting vertices onto one plane after the other: at corners the planes need not be at right angles."""


def within_outer_faces(mesh: Mesh, points: Points) -> Mesh:
    """The same faces, with vertices put onto the planes that they are outside of; any frame."""
    if len(points) < EIGHTH:
        return mesh
    normals = np.concatenate([np.eye(3), -np.eye(3), outer_normals(points)])
    first, last = len(points) - EIGHTH, len(points) - 1
    ordered = np.partition(points @ normals.T, (first, last), axis=0)
    limits = 2.0 * ordered[last] - ordered[first]
    vertices = mesh.vertices.copy()
    for _ in range(ROUNDS):
        for normal, limit in zip(normals, limits, strict=True):
            beyond = vertices @ normal - limit
            outside = np.flatnonzero(beyond > 0.0)
            vertices[outside] -= beyond[outside, None] * normal
    return Mesh(vertices, mesh.faces)


def outer_normals(points: Points) -> Float64[np.ndarray, "f 3"]:
    """Directions of the hull's faces, the largest first; none for points that have no hull."""
    try:
        hull = ConvexHull(points)
    except QhullError:
        return np.zeros((0, 3))
    corners = points[hull.simplices]
    areas = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    order = np.argsort(-areas, kind="stable")
    order = order[borne(corners[order].mean(axis=1), points)]
    left, share = hull.equations[order, :3], areas[order] / areas.sum()
    found: list[tuple[float, Float64[np.ndarray, " 3"]]] = []
    while len(left):
        alike = left @ left[0] > ALIKE
        mean = share[alike] @ left[alike]
        found.append((float(share[alike].sum()), mean / np.linalg.norm(mean)))
        left, share = left[~alike], share[~alike]
    found = sorted((one for one in found if one[0] >= LEAST_AREA), key=lambda one: -one[0])
    return np.array([normal for _, normal in found[:MOST_FACES]]).reshape(-1, 3)


def borne(middles: Points, points: Float64[np.ndarray, "m 3"]) -> Bool[np.ndarray, " n"]:
    """Which of these places have points of the cloud near them."""
    tree = KDTree(points)
    asked = points[:: max(1, len(points) // ASKED)]
    spacing = float(np.median(tree.query(asked, k=EIGHTH + 1, workers=-1)[0][:, EIGHTH]))
    return np.asarray(tree.query(middles, workers=-1)[0]) < SPAN * spacing

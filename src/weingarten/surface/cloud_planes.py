"""The planes in which the points of a cloud lie, as far as a field of the same surface agrees."""

import numpy as np
from scipy.spatial import KDTree

from weingarten.scan.facets import facets
from weingarten.scan.orientation import OTHERS
from weingarten.surface.planes import Measure, Planes, Points

CLEAR = 0.5
"""Least trust in a point's plane."""

AGREED = 0.9
"""Least |cosine| between its normal and the field's: beside an edge, but not on it, and not where a hole is
as small as the distance between the points, whose planes are chords of it."""


def cloud_planes(points: Points, measure: Measure) -> Planes:
    """Of the points that have one, in their own frame. measure: tells the field's, which give the sign."""
    near = np.asarray(KDTree(points).query(points, k=OTHERS + 1, workers=-1)[1])[:, 1:]
    own, field = facets(points, near), measure(points)
    cosine = np.einsum("nd,nd->n", field.normals, own.normals)
    kept = (own.trust > CLEAR) & (np.abs(cosine) > AGREED)
    normals = (np.sign(cosine)[:, None] * own.normals)[kept]
    return Planes(points[kept], normals, np.zeros(len(normals)))

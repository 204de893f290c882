"""Normals of faces, and two measures of how well two sets of them agree, whatever their signs."""

import numpy as np
from jaxtyping import Float64

from weingarten.mesh import Mesh

Normals = Float64[np.ndarray, "n 3"]


def face_normals(mesh: Mesh) -> Normals:
    """Unit outward normal of every face, (b − a) × (c − a) normalised; zero for a face without area."""
    cross = mesh.cross
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    return np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)


def alignment(a: Normals, b: Normals) -> Float64[np.ndarray, " n"]:
    """|a · b| of every pair: 1 parallel, 0 perpendicular, ½ on average for random directions."""
    return np.abs(np.einsum("ni,ni->n", a, b))


def elementwise_alignment(a: Normals, b: Normals) -> Float64[np.ndarray, " n"]:
    """Σᵢ |aᵢ bᵢ| of every pair: the published tables' measure, which depends on the axes.

    It is at least |a · b|, equal to it when either normal lies along an axis, and ¾ on average for random
    directions; (1,1,0)/√2 and (1,−1,0)/√2, which are perpendicular, score 1.
    """
    return np.einsum("ni,ni->n", np.abs(a), np.abs(b))

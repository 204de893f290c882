"""Fewer triangles where the surface is flat, within a stated distance of the mesh.

Edges are collapsed by least quadric error (Garland and Heckbert, "Surface simplification using quadric error
metrics", 1997, in fast-simplification). The error that it stops at adds up squared distances to ever more
planes and so bounds nothing: how far the surface moves is measured, both ways, and of ever greater errors the
last is taken whose mesh is within the tolerance. Collapses can fold it; folds are laid flat before that.
"""

from bisect import bisect_right
from dataclasses import dataclass
from functools import cache
from types import ModuleType

import numpy as np
from jaxtyping import Float64

from weingarten import extras
from weingarten.mesh import Mesh
from weingarten.metrics.distance import Nearby, closest
from weingarten.metrics.self_intersections import self_intersecting
from weingarten.metrics.topology import topology
from weingarten.surface.folds import unfolded

AGGRESSIVENESS, LAST = 3, 102
"""fast-simplification allows an error of 1e-9 iᵃ in its i-th round, i from 3 to LAST."""

ERRORS = 2.0 ** np.arange(-2.0, 6.5, 0.5)
"""Roots of the last round's error, tried in tolerances."""

STRIDE = 2
"""Between the errors that are tried when the mesh of the greatest within the tolerance is not as closed."""

SHARE = 0.999
"""Of all places measured, that are to be within the tolerance: folds of the mesh and what lies in them are
nobody's surface, and no mesh of few triangles comes near them."""

FOLD = 4.0
"""Tolerances that a vertex may be moved by where faces pass through each other."""

PROBES = 100_000
"""About so many places of a new mesh are measured, beside all vertices of the one that it stands for."""


@dataclass(frozen=True)
class Decimation:
    """A mesh that stands for another, and how far it is from it: at SHARE of all places, and at the worst."""

    mesh: Mesh
    distance: float
    farthest: float


def decimated(mesh: Mesh, tolerance: float) -> Decimation:
    """A mesh of few triangles within `tolerance` of the mesh, as closed, of as many pieces and handles.

    Both in the unit frame. No more of its faces pass through each other than before. What cannot do with
    fewer triangles is returned as it is. Raises MissingExtraError without the extra `simplify`.
    """
    original = Original(mesh)

    @cache
    def found(level: int) -> Decimation:
        fewer = collapsed(mesh, float(ERRORS[level]) * tolerance)
        return original.compared(unfolded(fewer, FOLD * tolerance))

    most = bisect_right(range(len(ERRORS)), tolerance, key=lambda level: found(level).distance)
    for level in range(most - 1, -1, -STRIDE):
        if len(found(level).mesh.faces) < len(mesh.faces) and original.like(found(level).mesh):
            return found(level)
    return Decimation(mesh, 0.0, 0.0)


class Original:
    """A mesh that others are to stand for."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh, self.near, self.kind = mesh, Nearby(mesh), kind(mesh)
        self.folded = int(self_intersecting(mesh).sum())

    def like(self, other: Mesh) -> bool:
        """Whether another mesh is of our kind, and no more folded."""
        return kind(other) == self.kind and int(self_intersecting(other).sum()) <= self.folded

    def compared(self, other: Mesh) -> Decimation:
        """Another mesh, with its distance from us both ways; infinite where nothing is left of it."""
        if not (other.areas > 0).any():
            return Decimation(other, np.inf, np.inf)
        there = self.near.closest(probes(other)).distance
        here = closest(other, self.mesh.vertices).distance
        most = max(np.quantile(there, SHARE), np.quantile(here, SHARE))
        return Decimation(other, float(most), float(max(there.max(), here.max())))


def kind(mesh: Mesh) -> tuple[object, ...]:
    """All of a mesh's topology that does not depend on how many triangles there are."""
    found = topology(mesh)
    return found.watertight, found.oriented, found.components, found.genus


def collapsed(mesh: Mesh, error: float) -> Mesh:
    """Edges collapsed, but those of a rim, until the next would cost a quadric error of error².

    The library knows no such bound, but has one at a scale of its own, so it is given the mesh in that.
    """
    scale = np.sqrt(1e-9 * float(LAST) ** AGGRESSIVENESS) / error
    vertices, faces = required().simplify(
        scale * mesh.vertices,
        mesh.faces.astype(np.int32),
        target_count=4,
        agg=AGGRESSIVENESS,
        preserve_border=True,
    )
    return Mesh(np.asarray(vertices) / scale, np.asarray(faces).astype(np.int64))


def probes(mesh: Mesh) -> Float64[np.ndarray, "n 3"]:
    """Places on all faces: (i a + j b + k c) / m with i + j + k = m for the corners a, b and c of each."""
    rows = int(np.clip(np.sqrt(2.0 * PROBES / len(mesh.faces)), 2, 40))
    corners = np.indices((rows + 1, rows + 1, rows + 1)).reshape(3, -1).T
    weights = corners[corners.sum(axis=1) == rows] / rows
    return np.einsum("nk,fkd->fnd", weights, mesh.vertices[mesh.faces]).reshape(-1, 3)


def required() -> ModuleType:
    """fast-simplification. Raises MissingExtraError, which says how to install it."""
    return extras.required("fast_simplification", "Fewer triangles need", "simplify")

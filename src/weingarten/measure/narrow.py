"""Planes narrower than the spacing of the points: rims of thin walls, bottoms of thin holes."""

import numpy as np
from jaxtyping import Int64
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from weingarten.measure.fitting import fitted
from weingarten.measure.growing import EXPLAINED, Region, some
from weingarten.measure.plane import Plane
from weingarten.measure.segmentation import FEWEST, fewest
from weingarten.measure.skin import Indices, Skin

NEAREST = 8
"""Points of one piece are among so many nearest of each other, however far apart a narrow strip has them."""

EXACTLY = 0.05
"""Share of the tolerance within which a point is on a plane by more than chance."""

MOSTLY = 0.9
"""Share of the points about a plane that have to be on it: else they are noisy, and its slabs no planes.
The same share of a bent surface's points has to be on a plane that takes its place."""


def narrow_planes(regions: list[Region], skin: Skin, tolerance: float) -> list[Region]:
    """Planes on which points of no region are, to a two-hundredth of their spacing; none where noise is.

    Nothing is asked of the field, which rounds what is so narrow. Free-form surface has no such planes: of a
    connected piece of it, a slab so thin holds a small share, and EXPLAINED of the piece is asked for.
    """
    if skin.noise > 0.0:
        return []
    free, found = np.ones(len(skin.points), dtype=bool), []
    for region in regions:
        free[region.members] = False
    while True:
        planes = [plane_of(piece, skin, tolerance) for piece in pieces(np.flatnonzero(free), skin)]
        fresh = [plane for plane in planes if plane is not None]
        if not fresh:
            return found
        for plane in fresh:
            free[plane.members] = False
        found += fresh


def flattened(regions: list[Region], skin: Skin, tolerance: float) -> list[Region]:
    """With planes in place of bent surfaces most of whose points lie exactly on one: only the field bends."""
    if skin.noise > 0.0:
        return regions
    return [flat_or_same(region, skin, tolerance) for region in regions]


def flat_or_same(region: Region, skin: Skin, tolerance: float) -> Region:
    """The plane that MOSTLY all points of a region lie on, else the region."""
    if isinstance(region.surface, Plane):
        return region
    plane = plane_of(region.members, skin, tolerance)
    return region if plane is None or len(plane.members) < MOSTLY * len(region.members) else plane


def pieces(index: Indices, skin: Skin) -> list[Int64[np.ndarray, " _"]]:
    """Points taken apart into those that are beside each other, whatever their normals."""
    if len(index) <= NEAREST:
        return []
    near = KDTree(skin.points[index]).query(skin.points[index], k=NEAREST + 1, workers=-1)[1]
    ends = near.ravel(), np.repeat(np.arange(len(index)), NEAREST + 1)
    graph = coo_matrix((np.ones(near.size, dtype=bool), ends), shape=(len(index), len(index)))
    label = connected_components(graph, directed=False)[1]
    order = np.argsort(label, kind="stable")
    return np.split(index[order], np.flatnonzero(np.diff(label[order])) + 1)


def plane_of(piece: Indices, skin: Skin, tolerance: float) -> Region | None:
    """The plane that most of a piece lies on exactly; None without one."""
    if len(piece) < Plane.FREEDOM * FEWEST:
        return None
    points, near = skin.points[piece], EXACTLY * tolerance
    guesses = Plane.guesses(skin.patch(some(piece)))
    best = max(guesses, key=lambda plane: np.count_nonzero(np.abs(plane.distance(points)) <= near))
    surface = fitted(best, points[np.abs(best.distance(points)) <= near], near)
    if surface is None:
        return None
    distance = np.abs(surface.distance(points))
    members, about = piece[distance <= near], np.count_nonzero(distance <= tolerance)
    if len(members) < max(fewest(surface, skin), EXPLAINED * len(piece), MOSTLY * about):
        return None
    return Region(surface, members, float(len(members)))

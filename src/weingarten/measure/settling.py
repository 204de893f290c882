"""Regions fitted to the points that are nearest to them, and those of one surface put together."""

from dataclasses import replace
from itertools import combinations

import numpy as np

from weingarten.measure.fitting import fitted
from weingarten.measure.growing import Region, some
from weingarten.measure.plane import Plane
from weingarten.measure.segmentation import EDGE, FEWEST
from weingarten.measure.skin import Skin

ROUNDS, STEPS = 3, 2
"""Of assignment and fit; how many neighbours beyond a region points may be taken from."""

MOST = 20_000
"""Points that a surface is fitted to in the end."""


def settled(regions: list[Region], skin: Skin, tolerance: float) -> list[Region]:
    """After ROUNDS rounds. Regions of which too little is left are gone."""
    for _ in range(ROUNDS):
        regions = [refitted(region, skin, tolerance) for region in assigned(regions, skin, tolerance)]
    return regions


def assigned(regions: list[Region], skin: Skin, tolerance: float) -> list[Region]:
    """Every point to the nearest surface of those that are beside it."""
    least = np.full(len(skin.points), tolerance)
    owner = np.full(len(skin.points), -1)
    for number, region in enumerate(regions):
        own = np.zeros(len(skin.points), dtype=bool)
        own[region.members] = True
        index = np.flatnonzero(skin.beside(own, STEPS))
        points = skin.points[index]
        distance = np.abs(region.surface.distance(points))
        facing = np.abs(np.einsum("nd,nd->n", region.surface.normals(points), skin.normals[index]))
        nearer = (distance < least[index]) & (facing >= EDGE)
        least[index[nearer]], owner[index[nearer]] = distance[nearer], number
    parts = [
        replace(region, members=np.flatnonzero(owner == number)) for number, region in enumerate(regions)
    ]
    return [part for part in parts if len(part.members) >= FEWEST * part.surface.FREEDOM]


def refitted(region: Region, skin: Skin, tolerance: float) -> Region:
    """By all of its points, but those that are not its own."""
    points = skin.points[some(region.members, MOST)]
    surface = fitted(region.surface, points, 1e-3 * tolerance)
    return region if surface is None else replace(region, surface=surface)


def merged(regions: list[Region], skin: Skin, tolerance: float) -> list[Region]:
    """With those put together that lie on one surface and face the same way. Separate flat faces stay so."""
    regions = sorted(regions, key=lambda region: -len(region.members))
    changed = True
    while changed:
        changed = False
        for one, other in combinations(range(len(regions)), 2):
            both = joined(regions[one], regions[other], skin, tolerance)
            if both is not None:
                regions = [both, *(r for n, r in enumerate(regions) if n not in (one, other))]
                changed = True
                break
    return regions


def joined(one: Region, other: Region, skin: Skin, tolerance: float) -> Region | None:
    """Both as one region; None where they are of different surfaces."""
    if one.surface.KIND != other.surface.KIND or facing(one, skin) != facing(other, skin):
        return None
    theirs = skin.points[some(other.members)]
    if np.median(np.abs(one.surface.distance(theirs))) > 3.0 * tolerance:
        return None
    members = np.concatenate([one.members, other.members])
    half = min(len(one.members), len(other.members))
    mine = skin.points[some(one.members, half)]
    surface = fitted(one.surface, np.concatenate([mine, skin.points[some(other.members, half)]]), tolerance)
    if surface is None or not surface.sensible(1.0):
        return None
    if isinstance(surface, Plane) and not adjacent(one, other, skin):
        return None
    off = [
        float(np.median(np.abs(surface.distance(skin.points[region.members])))) for region in (one, other)
    ]
    return Region(surface, members, one.score + other.score) if max(off) <= 0.5 * tolerance else None


def adjacent(one: Region, other: Region, skin: Skin) -> bool:
    """Whether points of one region are neighbours of the other's."""
    first, second = (np.zeros(len(skin.points), dtype=bool) for _ in range(2))
    first[one.members], second[other.members] = True, True
    return bool((skin.beside(first, 1) & second).any())


def facing(region: Region, skin: Skin) -> bool:
    """Whether the part's outside is where the surface's normals point: a boss, not a hole."""
    members = some(region.members)
    normals = region.surface.normals(skin.points[members])
    return float(np.einsum("nd,nd->n", normals, skin.normals[members]).mean()) > 0.0

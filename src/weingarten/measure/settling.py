"""Regions fitted to the points that are nearest to them, and those of one surface put together."""

from dataclasses import dataclass, replace

import numpy as np

from weingarten.measure.fitting import fitted
from weingarten.measure.growing import EDGE, Region, some
from weingarten.measure.plane import Plane
from weingarten.measure.segmentation import fewest
from weingarten.measure.skin import Indices, Mask, Skin
from weingarten.measure.surface import Values

ROUNDS, STEPS = 3, 2
"""Of assignment and fit; how many neighbours beyond a region points may be taken from."""

ALONE = 0.3
"""A surface is fitted to the points that are on no other one where these are so large a share of its own."""

NEARLY, WIDER = 0.6, 1.5
"""A region is not needed of whose points a share of NEARLY is within WIDER tolerances of larger ones."""

MOST = 20_000
"""Points that a surface is fitted to in the end."""


@dataclass(frozen=True, eq=False)
class Claim:
    """Points that a region's surface passes by, and how near."""

    index: Indices
    distance: Values

    @classmethod
    def of(cls, region: Region, skin: Skin, tolerance: float) -> "Claim":
        """Those of the region's and beside it that are within the tolerance and do not face elsewhere."""
        own = np.zeros(len(skin.points), dtype=bool)
        own[region.members] = True
        index = np.flatnonzero(skin.beside(own, STEPS))
        points = skin.places[index]
        distance = np.abs(region.surface.distance(points))
        facing = np.abs(np.einsum("nd,nd->n", region.surface.normals(points), skin.normals[index]))
        on = (distance < tolerance) & (facing >= EDGE)
        return cls(index[on], distance[on])


def settled(regions: list[Region], skin: Skin, tolerance: float) -> list[Region]:
    """After ROUNDS rounds of assignment and fit. Regions of which too little is left are gone."""
    for _ in range(ROUNDS):
        claims = [Claim.of(region, skin, tolerance) for region in regions]
        claimed = np.zeros(len(skin.points), dtype=np.int64)
        for claim in claims:
            claimed[claim.index] += 1
        parts = assigned(regions, claims, len(skin.points))
        fitted_ones = [refitted(part, skin, tolerance, claimed == 1) for part in parts]
        regions = [one for one in fitted_ones if one is not None]
    return regions


def assigned(regions: list[Region], claims: list[Claim], count: int) -> list[Region]:
    """Every point to the nearest surface of those that claim it."""
    least, owner = np.full(count, np.inf), np.full(count, -1)
    for number, claim in enumerate(claims):
        nearer = claim.distance < least[claim.index]
        index = claim.index[nearer]
        least[index], owner[index] = claim.distance[nearer], number
    return [replace(region, members=np.flatnonzero(owner == number)) for number, region in enumerate(regions)]


def refitted(region: Region, skin: Skin, tolerance: float, sole: Mask) -> Region | None:
    """By its points; None where there are too few, or the surface is none of its kind any more.

    sole: points that one surface alone passes by. Where two do, as where a fillet begins, noise decides whose
    each is, and would move both: those are left out where enough others are there.
    """
    least = fewest(region.surface, skin)
    if len(region.members) < least:
        return None
    alone = region.members[sole[region.members]]
    members = alone if len(alone) >= max(least, ALONE * len(region.members)) else region.members
    surface = fitted(region.surface, skin.points[some(members, MOST)], 1e-3 * tolerance)
    if surface is None or not surface.sensible(1.0):
        return None
    return replace(region, surface=surface)


def needed(regions: list[Region], skin: Skin, tolerance: float) -> list[Region]:
    """Without those whose points are nearly all on the surfaces of larger ones beside them too."""
    kept: list[Region] = []
    regions = [region for region in regions if len(region.members)]
    passed = np.zeros(len(skin.points), dtype=bool)
    for region in sorted(regions, key=lambda region: -len(region.members)):
        if passed[region.members].mean() < NEARLY:
            kept.append(region)
            passed[Claim.of(region, skin, WIDER * tolerance).index] = True
    return kept


def merged(regions: list[Region], skin: Skin, tolerance: float) -> list[Region]:
    """With those put together that lie on one surface and face the same way. Separate flat faces stay so.

    The larger first: each is joined to the first of the larger ones that it fits.
    """
    kept: list[Region] = []
    for region in sorted(regions, key=lambda region: -len(region.members)):
        for number, larger in enumerate(kept):
            both = joined(larger, region, skin, tolerance)
            if both is not None:
                kept[number] = both
                break
        else:
            kept.append(region)
    return kept


def joined(one: Region, other: Region, skin: Skin, tolerance: float) -> Region | None:
    """Both as one region; None where they are of different surfaces."""
    if one.surface.KIND != other.surface.KIND:
        return None
    theirs = skin.points[some(other.members)]
    if np.median(np.abs(one.surface.distance(theirs))) > 3.0 * tolerance:
        return None
    if facing(one, skin) != facing(other, skin):
        return None
    members = np.concatenate([one.members, other.members])
    half = min(len(one.members), len(other.members))
    mine = skin.points[some(one.members, half)]
    surface = fitted(one.surface, np.concatenate([mine, skin.points[some(other.members, half)]]), tolerance)
    if surface is None or not surface.sensible(1.0):
        return None
    if isinstance(surface, Plane) and not adjacent(one, other, skin):
        return None
    off = [float(np.median(np.abs(surface.distance(skin.points[region.members])))) for region in (one, other)]
    return Region(surface, members, one.score + other.score) if max(off) <= 0.5 * tolerance else None


def adjacent(one: Region, other: Region, skin: Skin) -> bool:
    """Whether points of one region are neighbours of the other's."""
    first, second = (np.zeros(len(skin.points), dtype=bool) for _ in range(2))
    first[one.members], second[other.members] = True, True
    return bool((skin.beside(first, STEPS) & second).any())


def facing(region: Region, skin: Skin) -> bool:
    """Whether the part's outside is where the surface's normals point: a boss, not a hole."""
    members = some(region.members)
    normals = region.surface.normals(skin.points[members])
    return float(np.einsum("nd,nd->n", normals, skin.normals[members]).mean()) > 0.0

"""A skin taken apart into regions of one surface each."""

import numpy as np
from jaxtyping import Int64

from weingarten.measure.growing import EDGE, KINDS, NARROW, Region, bent_alike, explained
from weingarten.measure.skin import Indices, Mask, Skin
from weingarten.measure.surface import Surface

PATCHES = ((48, 1.0, KINDS), (20, 1.0, KINDS), (48, np.inf, KINDS), (20, np.inf, NARROW))
"""Points that a surface is guessed from, how much their curvatures may differ (slack), and kinds.

Fewer points where a surface is narrow; any curvature where the field's are not to be trusted, or where it
rounds all of a surface, which so little then tells that only the simplest kinds are looked for."""

MOST_FAILURES = 80
"""Patches that no primitive explains, one after the other or not, after which the rest is free-form."""

FEWEST, FEWEST_NOISY = 4, 12
"""A region has at least so many points for every degree of freedom; and where points are noisy."""


def fewest(surface: Surface, skin: Skin) -> int:
    """Points that make a region."""
    return surface.FREEDOM * (FEWEST_NOISY if skin.noise > 0.0 else FEWEST)


def segmented(skin: Skin, tolerance: float) -> list[Region]:
    """Regions, from seeds where the surface is the smoothest."""
    free, found = np.ones(len(skin.points), dtype=bool), []
    order = np.argsort(skin.rough, kind="stable")
    for size, slack, kinds in PATCHES:
        tried, failures = np.zeros(len(free), dtype=bool), 0
        for seed in order:
            if not free[seed] or tried[seed]:
                continue
            if failures == MOST_FAILURES:
                break
            patch = around(int(seed), skin, free, size, slack)
            tried[seed] = True
            if len(patch) < size / 2:
                continue
            region = explained(patch, skin, tolerance, slack, free, kinds)
            if region is None or len(region.members) < fewest(region.surface, skin):
                tried[patch] = True
                failures += 1
                continue
            found.append(region)
            free[region.members] = False
            free[edging(region, skin, tolerance, free)] = False
    return found


def around(seed: int, skin: Skin, free: Mask, size: int, slack: float) -> Indices:
    """A patch of free points about a seed, of about its curvatures."""
    allowed = free & bent_alike(skin.curvatures, skin.curvatures[seed][None], skin.spacing, slack)
    patch = skin.connected(allowed, np.array([seed]), size)
    distance = ((skin.places[patch] - skin.places[seed]) ** 2).sum(axis=1)
    return patch[np.sort(np.argsort(distance, kind="stable")[:size])]


def edging(region: Region, skin: Skin, tolerance: float, free: Mask) -> Int64[np.ndarray, " m"]:
    """Free points beside a region that lie on its surface too, where the field rounds its edge."""
    beside = np.zeros(len(free), dtype=bool)
    beside[region.members] = True
    index = np.flatnonzero(skin.beside(beside, 3) & free)
    points = skin.places[index]
    facing = np.abs(np.einsum("nd,nd->n", region.surface.normals(points), skin.normals[index]))
    return index[(np.abs(region.surface.distance(points)) <= tolerance) & (facing >= EDGE)]

"""From a few points to the whole of the surface that they are a part of."""

from dataclasses import dataclass

import numpy as np

from weingarten.measure.cone import Cone
from weingarten.measure.cylinder import Cylinder
from weingarten.measure.fitting import fitted
from weingarten.measure.plane import Plane
from weingarten.measure.skin import Indices, Mask, Skin
from weingarten.measure.sphere import Sphere
from weingarten.measure.surface import Surface
from weingarten.measure.torus import Torus

KINDS: tuple[type[Surface], ...] = (Plane, Cylinder, Sphere, Cone, Torus)
"""The simplest first."""

FACING = np.cos(np.radians(30.0))
"""Normals of a point and of its surface differ by no more while it grows."""

GROWTHS, GROWN = 8, 1.02
"""How often a surface is fitted again while it grows, and by what factor it has to."""

SOME = 400
"""Points that are enough to fit a growing surface to."""

SUFFICES = 0.9
"""A kind explains points as well as another if its score is at least so large a share of the other's."""


@dataclass(frozen=True, eq=False)
class Region:
    """A surface and the points of a skin that lie on it.

    score: Σ 1 − (d/ε)² over them, so that a surface that merely passes by counts less than one that fits.
    """

    surface: Surface
    members: Indices
    score: float


def some(members: Indices, most: int = SOME) -> Indices:
    """Evenly picked."""
    return members[:: max(1, -(-len(members) // most))]


def lies_on(surface: Surface, skin: Skin, tolerance: float, free: Mask) -> Mask:
    """Which free points do, of those that face as it does, or all the other way round (a hole)."""
    index = np.flatnonzero(free)
    points = skin.points[index]
    near = np.abs(surface.distance(points)) <= tolerance
    index, points = index[near], points[near]
    facing = np.abs(np.einsum("nd,nd->n", surface.normals(points), skin.normals[index]))
    mask = np.zeros(len(free), dtype=bool)
    mask[index[facing >= FACING]] = True
    return mask


def grown(surface: Surface, patch: Indices, skin: Skin, tolerance: float, free: Mask) -> Region | None:
    """A guess fitted to its patch and grown as far as it goes; None where it does not even explain that."""
    members, best = patch, None
    for _ in range(GROWTHS):
        better = fitted(surface, skin.points[some(members)], 0.1 * tolerance)
        if better is None or not better.sensible(1.0):
            break
        surface = better
        mask = lies_on(surface, skin, tolerance, free)
        if best is None and np.count_nonzero(mask[patch]) < 0.5 * len(patch):
            return None
        found = skin.connected(mask, patch)
        distance = surface.distance(skin.points[found]) / tolerance
        region = Region(surface, found, float((1.0 - distance**2).sum()))
        larger = best is None or region.score > GROWN * best.score
        if best is None or region.score > best.score:
            best = region
        if not larger:
            break
        members = found
    return best


def explained(patch: Indices, skin: Skin, tolerance: float, free: Mask) -> Region | None:
    """The simplest kind that explains about as many points around a patch as any does."""
    found = []
    for kind in KINDS:
        grown_ones = [grown(guess, patch, skin, tolerance, free) for guess in kind.guesses(skin.patch(patch))]
        regions = [region for region in grown_ones if region is not None]
        if regions:
            found.append(max(regions, key=lambda region: region.score))
        if found and kind is Plane and certain(found[0], skin, tolerance):
            break
    if not found:
        return None
    best = max(region.score for region in found)
    return next(region for region in found if region.score >= SUFFICES * best)


def certain(region: Region, skin: Skin, tolerance: float) -> bool:
    """Whether a surface fits so well that no other need be tried."""
    distance = np.abs(region.surface.distance(skin.points[region.members]))
    return len(region.members) > SOME / 10 and float(np.quantile(distance, 0.9)) < 0.05 * tolerance

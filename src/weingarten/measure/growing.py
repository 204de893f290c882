"""From a few points to the whole of the surface that they are a part of."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from weingarten.measure.cone import Cone
from weingarten.measure.cylinder import Cylinder
from weingarten.measure.fitting import ROUNDS, fitted
from weingarten.measure.plane import Plane
from weingarten.measure.skin import Indices, Mask, Skin
from weingarten.measure.sphere import Sphere
from weingarten.measure.surface import Surface
from weingarten.measure.torus import Torus

KINDS: tuple[type[Surface], ...] = (Plane, Cylinder, Sphere, Cone, Torus)
"""The simplest first."""

NARROW = KINDS[:2]
"""Those that few points tell, where the field says nothing."""

FACING = np.cos(np.radians(30.0))
"""Normals of a point and of its surface differ by no more while it grows."""

EDGE = np.cos(np.radians(75.0))
"""The same beside edges, and where surfaces are so narrow that the field rounds all of them."""

LOOSE = 0.6
"""Share of the tolerance at which a point counts nothing; beyond, it counts against a surface."""

BEND, FLAT = 0.4, 0.05
"""Curvatures are alike that differ by at most BEND of the greater, or FLAT over the spacing of the points."""

GROWTHS, GROWN = 8, 1.02
"""How often a surface is fitted again while it grows, and by what factor it has to."""

FIRST_ROUNDS = 2
"""Of fitting to a patch, before it is known whether there is anything to it."""

SOME = 400
"""Points that are enough to fit a growing surface to."""

EXPLAINED = 0.4
"""Share of a patch that a surface fitted to it has to explain."""

SUFFICES = 0.9
"""A kind explains points as well as another if its score is at least so large a share of the other's."""


@dataclass(frozen=True, eq=False)
class Region:
    """A surface and the points of a skin that lie on it.

    score: Σ 1 − (d/ε')² − (1 − cos θ)/(1 − cos 30°) over them, ε' = LOOSE ε and θ the angle between the
    surface's normal and the field's, so that a surface that merely passes by counts less than one that fits.
    """

    surface: Surface
    members: Indices
    score: float


def some(members: Indices, most: int = SOME) -> Int64[np.ndarray, " s"]:
    """Evenly picked."""
    return members[:: max(1, -(-len(members) // most))]


def lies_on(surface: Surface, skin: Skin, tolerance: float, slack: float, free: Mask) -> Mask:
    """Which free points do: near it, facing as it does or all the other way (a hole), and as bent as it is.

    slack: how much their curvatures may differ, see `bent_alike`.
    """
    index = np.flatnonzero(free)
    index = index[np.abs(surface.distance(skin.places[index])) <= tolerance]
    points = skin.places[index]
    facing = np.einsum("nd,nd->n", surface.normals(points), skin.normals[index])
    side = 1.0 if facing.sum() > 0.0 else -1.0
    bend = np.sort(side * surface.curvatures(points), axis=1)
    alike = bent_alike(skin.curvatures[index], bend, skin.spacing, slack)
    mask = np.zeros(len(free), dtype=bool)
    mask[index[(side * facing >= (FACING if np.isfinite(slack) else EDGE)) & alike]] = True
    return mask


def bent_alike(
    one: Float64[np.ndarray, "n 2"], other: Float64[np.ndarray, "#n 2"], spacing: float, slack: float
) -> Mask:
    """Whether curvatures differ by at most slack × BEND of the other's greater, or slack × FLAT / spacing."""
    change = np.maximum(np.abs(one[:, 0] - other[:, 0]), np.abs(one[:, 1] - other[:, 1]))
    bend = np.maximum(np.abs(other[:, 0]), np.abs(other[:, 1]))
    return change <= slack * np.maximum(BEND * bend, FLAT / spacing)


def score(surface: Surface, members: Indices, skin: Skin, tolerance: float) -> float:
    """Of `Region`."""
    points = skin.places[members]
    off = (surface.distance(points) / (LOOSE * tolerance)) ** 2
    facing = np.abs(np.einsum("nd,nd->n", surface.normals(points), skin.normals[members]))
    turned = (1.0 - np.minimum(facing, 1.0)) / (1.0 - FACING)
    return float((1.0 - off - turned).sum())


def grown(
    surface: Surface, patch: Indices, skin: Skin, tolerance: float, slack: float, free: Mask
) -> Region | None:
    """A guess fitted to its patch and grown as far as it goes; None where it does not even explain that."""
    members, best = patch, None
    for _ in range(GROWTHS):
        rounds = FIRST_ROUNDS if best is None else ROUNDS
        better = fitted(surface, skin.places[some(members)], 0.1 * tolerance, rounds)
        if better is None or not better.sensible(1.0):
            break
        surface = better
        mask = lies_on(surface, skin, tolerance, slack, free)
        if best is None and np.count_nonzero(mask[patch]) < EXPLAINED * len(patch):
            return None
        found = skin.connected(mask, patch)
        region = Region(surface, found, score(surface, found, skin, tolerance))
        larger = best is None or region.score > GROWN * best.score
        if best is None or region.score > best.score:
            best = region
        if not larger:
            break
        members = found
    return best


def explained(
    patch: Indices, skin: Skin, tolerance: float, slack: float, free: Mask, kinds: tuple[Any, ...]
) -> Region | None:
    """The simplest kind that explains about as many points around a patch as any does."""
    found = []
    for kind in kinds:
        grown_ones = [
            grown(guess, patch, skin, tolerance, slack, free) for guess in kind.guesses(skin.patch(patch))
        ]
        regions = [region for region in grown_ones if region is not None]
        if regions:
            found.append(max(regions, key=lambda region: region.score))
        if regions and certain(found[-1], skin, tolerance):
            break
    best = max((region.score for region in found), default=0.0)
    if best <= 0.0:
        return None
    return next(region for region in found if region.score >= SUFFICES * best)


def certain(region: Region, skin: Skin, tolerance: float) -> bool:
    """Whether a surface fits so well that no other need be tried."""
    distance = np.abs(region.surface.distance(skin.places[region.members]))
    return len(region.members) > SOME / 10 and float(np.quantile(distance, 0.9)) < 0.05 * tolerance

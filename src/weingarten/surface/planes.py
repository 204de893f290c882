"""The planes in which a surface lies where it meets lattice edges, with rounded edges made sharp again.

A fitted field cannot turn at once: about a sharp edge its level sets are round over some hundredths of a
unit. What is measured within the round says nothing of the edge. So there the plane at a point is replaced by
the one that the flatter surface beside it has: the mode, near the point's own normal, of the normals around,

    m ← Σ_j w_j n_j / ‖…‖,   w_j = exp(−‖p_j − p‖² / 2σ²) exp(−‖n_j − m‖² / 2τ²) / (1 + (ρ κ_j)²)²,

by mean shift from m = n (as the bilateral filters of normals have it, Zheng et al. 2011), moved along m to
where it meets the same points: Σ_j w_j ½ (m + n_j)·(p_j − p − t m) = 0. That leaves circles and spheres as
they are, for a chord of a circle is at right angles to the mean of its ends' normals.

Planes that are known otherwise (`weingarten.surface.cloud_planes`) take part with WORTH times the weight: a
fitted field turns by 45 degrees over so wide a round that nothing flat is left to be found beside it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64
from scipy.spatial import KDTree

from weingarten.crew import Crew

Points = Float64[np.ndarray, "n 3"]

SPREAD, TURN, ROUND = 0.015, 0.2, 0.03
"""σ, unit lengths; τ, no unit; ρ, unit lengths."""

REACH = 2.2 * SPREAD
"""Points further away have no weight, unit lengths."""

BENT = 6.0
"""κ below which a plane is left as it is, one over unit length."""

WORTH = 10.0
"""Of a plane that is known otherwise: some ten lattice edges have a crossing where a cloud has a point."""

MOST, SHIFTS, PIECE = 96, 5, 2_000
"""Neighbours at most; mean shifts; points at a time."""


@dataclass(frozen=True)
class Planes:
    """points: on the surface, unit frame. normals: outward. bend: the greater |κ|, one over unit length."""

    points: Points
    normals: Points
    bend: Float64[np.ndarray, " n"]

    @property
    def trust(self) -> Float64[np.ndarray, " n"]:
        """1 / (1 + (ρ κ)²)²."""
        return (1.0 + (ROUND * self.bend) ** 2) ** -2


NOTHING = Planes(np.empty((0, 3)), np.empty((0, 3)), np.empty(0))
"""No planes."""

Measure = Callable[[Points], Planes]
"""The planes of a surface near given points."""


def unrounded(planes: Planes, known: Planes = NOTHING, crew: Crew | None = None) -> tuple[Points, Points]:
    """Points and normals, in the round replaced by those of the surface beside it.

    known: planes of the same surface that nothing has rounded. crew: who does the work.
    """
    points, normals = planes.points.copy(), planes.normals.copy()
    bent = np.nonzero(planes.bend > BENT)[0]
    if len(bent) == 0:
        return points, normals
    trust = np.concatenate([planes.trust, WORTH * known.trust])
    beside = np.concatenate([planes.points, known.points])
    facing = np.concatenate([planes.normals, known.normals]).T.copy()
    tree = KDTree(beside)

    def turn(piece: Int64[np.ndarray, " m"]) -> None:
        own = planes.points[piece]
        distance, around = tree.query(own, k=MOST, distance_upper_bound=REACH)
        there = np.isfinite(distance)
        around = np.where(there, around, piece[:, None])
        share = np.exp(-0.5 * (distance / SPREAD) ** 2) * trust[around]
        chord = beside.T[:, around] - own.T[:, :, None]
        move, normals[piece] = shifted(planes.normals[piece], facing[:, around], chord, share)
        points[piece] = own + move

    crew = crew or Crew()
    with crew:
        crew.map(turn, np.array_split(bent, -(-len(bent) // PIECE)))
    return points, normals


def shifted(
    mode: Points,
    normals: Float64[np.ndarray, "3 m k"],
    chord: Float64[np.ndarray, "3 m k"],
    share: Float64[np.ndarray, "m k"],
) -> tuple[Points, Points]:
    """t m and m of some planes.

    mode: their normals. normals: of their neighbours, at the ends of chord. share: of the weights, what
    stays.
    """
    for _ in range(SHIFTS):
        total = np.einsum("mk,cmk->mc", weights(mode, normals, share), normals)
        length = np.linalg.norm(total, axis=1, keepdims=True)
        mode = np.where(length > 0.0, total / np.maximum(length, 1e-300), mode)
    weight = weights(mode, normals, share)
    above = 0.5 * np.einsum("mk,mk->m", weight, along(mode, chord) + np.einsum("cmk,cmk->mk", normals, chord))
    whole = 0.5 * np.einsum("mk,mk->m", weight, 1.0 + along(mode, normals))
    move = np.divide(above, whole, out=np.zeros_like(above), where=whole > 1e-9)
    return move.clip(-0.5 * REACH, 0.5 * REACH)[:, None] * mode, mode


def weights(
    mode: Points, normals: Float64[np.ndarray, "3 m k"], share: Float64[np.ndarray, "m k"]
) -> Float64[np.ndarray, "m k"]:
    """w, with normals far from the mode left out: ‖n − m‖² = 2 − 2 n·m."""
    return share * np.exp((along(mode, normals) - 1.0) / TURN**2)


def along(mode: Points, vectors: Float64[np.ndarray, "3 m k"]) -> Float64[np.ndarray, "m k"]:
    """Their components along the mode."""
    return np.einsum("mc,cmk->mk", mode, vectors)

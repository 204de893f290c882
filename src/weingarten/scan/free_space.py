"""Signs from empty space: where a closed cloud leaves room, inside and outside are known without normals.

Grid cells nearer than τ to a point are shell; the rest falls into connected rooms. The room that holds the
box's boundary is outside, the others are inside (findings, "Signs from free space"). Said of nothing that is
in doubt:

- rooms that a thinner shell (0.85 τ) opens to the outside: pockets behind a mouth narrower than 2τ;
- rooms that do not lie against the outside: voids within the solid;
- where no inside is found (walls thinner than 2τ, or an open surface that the flood leaks through): every
  cell that does not see the boundary of the box along three of the six axes.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int8, Int32
from scipy.ndimage import distance_transform_edt, label
from scipy.spatial import cKDTree

SHELL = 1.5
"""τ in median distances to the 8th neighbour; the largest hole of N uniform samples is about 1.2 of them."""

THIN_SHELL = 0.85
"""The thinner shell, in τ."""

CELLS = 160
"""Cells along a side of the box at most."""

OPEN_VIEWS = 3
"""Of the six axis directions, how many must be open for a cell to count as outside when there is no inside."""

OUTSIDE = 1
"""The number `label` gives to the room that holds the padded corner: it comes first in scan order."""


@dataclass(frozen=True)
class FreeSpace:
    """Labels of a cubic grid over the box: +1 outside, −1 inside, 0 unknown; all in the unit frame."""

    labels: Int8[np.ndarray, "a b c"]
    lower: float
    cell: float
    shell: float
    notes: tuple[str, ...]

    @classmethod
    def of(cls, points: Float64[np.ndarray, "n 3"], tree: cKDTree, reach: float) -> "FreeSpace":
        """Label the box [−reach, reach]³ around a cloud in the unit frame."""
        probe = points[:: max(1, len(points) // 20_000)]
        spacing = float(np.median(tree.query(probe, k=9, workers=-1)[0][:, 8]))
        shell = max(SHELL * spacing, 4.0 * reach / CELLS)
        count = int(min(CELLS, np.ceil(2.0 * reach / (shell / 2.5))))
        cell = 2.0 * reach / count
        distance = grid_distance(points, tree, count, reach, cell, shell)
        rooms, room_count = label(np.pad(distance > shell, 1, constant_values=True))
        rooms = rooms[1:-1, 1:-1, 1:-1]
        outside, inside = rooms == OUTSIDE, enclosed(rooms, room_count, distance, shell, cell)
        notes: tuple[str, ...] = ()
        if not inside.any():
            outside &= open_views(rooms > 0) >= OPEN_VIEWS
            notes = (
                f"No inside was found: the walls are thinner than {100 * shell:.1f} % of the part's largest side, "
                "or the surface is open; fewer signs are taken from free space.",
            )
        return cls(outside.astype(np.int8) - inside.astype(np.int8), -reach, cell, shell, notes)

    def signs(self, points: Float64[np.ndarray, "n 3"]) -> Int8[np.ndarray, " n"]:
        """+1, −1 or 0 (unknown) at points of the box."""
        top = len(self.labels) - 1
        index = np.clip(((points - self.lower) / self.cell).astype(np.int64), 0, top)
        return self.labels[tuple(index.T)]

    @property
    def known_inside(self) -> float:
        """Fraction of the box known to be inside."""
        return float(np.mean(self.labels < 0))


def grid_distance(
    points: Float64[np.ndarray, "n 3"], tree: cKDTree, count: int, reach: float, cell: float, shell: float
) -> Float32[np.ndarray, "a b c"]:
    """Distance from cell centres to the cloud: exact where it decides about the shell, else to a cell or so."""
    occupied = np.zeros((count, count, count), dtype=bool)
    occupied[tuple(np.clip(((points + reach) / cell).astype(np.int64), 0, count - 1).T)] = True
    distance = distance_transform_edt(~occupied, sampling=cell).astype(np.float32)
    near = np.abs(distance - 0.925 * shell) < 0.075 * shell + np.sqrt(0.75) * cell
    centres = cell * (np.argwhere(near) + 0.5) - reach
    distance[near] = tree.query(centres, workers=-1)[0]
    return distance


def enclosed(
    rooms: Int32[np.ndarray, "a b c"],
    count: int,
    distance: Float32[np.ndarray, "a b c"],
    shell: float,
    cell: float,
) -> Bool[np.ndarray, "a b c"]:
    """Cells of the rooms that are inside: closed to a thinner shell, and against the outside."""
    thin_rooms, _ = label(np.pad(distance > THIN_SHELL * shell, 1, constant_values=True))
    leaky = np.unique(rooms[thin_rooms[1:-1, 1:-1, 1:-1] == OUTSIDE])
    beside = distance_transform_edt(rooms != OUTSIDE, sampling=cell) < 2.0 * shell + 4.0 * cell
    inside = np.zeros(count + 1, dtype=bool)
    inside[np.unique(rooms[beside])] = True
    inside[leaky] = False
    inside[[0, OUTSIDE]] = False
    return inside[rooms]


def open_views(free: Bool[np.ndarray, "a b c"]) -> Int8[np.ndarray, "a b c"]:
    """In how many of the six axis directions a cell sees the boundary of the box through free cells."""
    views = np.zeros(free.shape, dtype=np.int8)
    for axis in range(3):
        views += np.logical_and.accumulate(free, axis=axis)
        views += np.flip(np.logical_and.accumulate(np.flip(free, axis), axis=axis), axis)
    return views

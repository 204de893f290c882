"""Signs from empty space: where a closed cloud leaves room, inside and outside are known without normals.

Grid cells nearer than τ to a point are shell; the rest falls into connected rooms. The room that holds the
box's boundary is outside, the others are inside. Said of nothing that is
in doubt:

- rooms that a thinner shell (0.9 τ) opens to the outside: pockets behind a mouth narrower than 2τ;
- rooms that do not lie against the outside: voids within the solid;
- outside cells that see the boundary of the box along none of the six axes: one half of a part may leak;
- where no inside is found with any τ (walls too thin, or a surface so open that the flood leaks in): cells
  that see the boundary along fewer than three of the axes.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int8, Int32, Int64
from scipy.ndimage import binary_dilation, label
from scipy.spatial import KDTree

SHELLS = (1.65, 2.0, 2.4)
"""τ in median distances to the 8th neighbour, the first that finds an inside; the largest hole of N uniform
samples is about 1.2 of them."""

THIN_SHELL = 0.9
"""The thinner shell, in τ."""

CLEARANCE = 0.75
"""A room's label reaches into the shell up to this distance from the points, in τ: no hole is so large."""

ROOM = 2.0
"""The grid ends so far beyond the unit cube at least, in τ."""

CELLS = 160
"""Cells along a side of the box at most."""

LEAST_VIEWS, MANY_VIEWS = 1, 3
"""Of the six axis directions, how many must be open for an outside cell, with an inside found and without."""

TOLD, BEYOND = 8, 190
"""Cells up to which a distance is told: a shell is some 2.5 of them wide, what lies beside it 6.8. And what
stands for the square of more; with TOLD² added it still fits into a byte."""

OUTSIDE = 1
"""The number `label` gives to the room that holds the padded corner: it comes first in scan order."""


@dataclass(frozen=True)
class FreeSpace:
    """Labels of a cubic grid over the box: +1 outside, −1 inside, 0 unknown; all in the unit frame.

    tree: of the cloud. shell: τ. notes: what the user should know of the signs.
    """

    tree: KDTree
    labels: Int8[np.ndarray, "a b c"]
    lower: float
    cell: float
    shell: float
    notes: tuple[str, ...]

    @classmethod
    def of(cls, points: Float64[np.ndarray, "n 3"], tree: KDTree, reach: float) -> "FreeSpace":
        """Label the box [−reach, reach]³ about a cloud in the unit frame, or one with ROOM about it."""
        probe = points[:: max(1, len(points) // 20_000)]
        spacing = float(np.median(tree.query(probe, k=9, workers=-1)[0][:, 8]))
        shells = sorted({max(factor * spacing, 4.0 * reach / CELLS) for factor in SHELLS})
        first = cls.with_shell(points, tree, reach, shells[0])
        if first.known_inside > 0.0:
            return first
        others = (cls.with_shell(points, tree, reach, shell) for shell in shells[1:])
        return next((space for space in others if space.known_inside > 0.0), first)

    @classmethod
    def with_shell(
        cls, points: Float64[np.ndarray, "n 3"], tree: KDTree, reach: float, shell: float
    ) -> "FreeSpace":
        """The labels that one τ gives."""
        # the cloud touches the unit cube: without a layer of free cells a cube would have no outside
        reach = max(reach, 1.0 + ROOM * shell)
        count = int(min(CELLS, np.ceil(2.0 * reach / (shell / 2.5))))
        cell = 2.0 * reach / count
        distance = grid_distance(points, tree, count, reach, cell, shell)
        rooms = connected(distance > shell)
        outside, inside = rooms == OUTSIDE, enclosed(rooms, distance, shell, cell)
        notes: tuple[str, ...] = ()
        if not inside.any():
            notes = (
                f"No inside was found: the walls are thinner than {100 * shell:.1f} % of the part's largest "
                "side, or the surface is open; fewer signs are taken from free space.",
            )
        outside &= open_views(rooms > 0) >= (LEAST_VIEWS if inside.any() else MANY_VIEWS)
        beside = distance > CLEARANCE * shell
        outside, inside = binary_dilation(outside, mask=beside), binary_dilation(inside, mask=beside)
        return cls(tree, outside.astype(np.int8) - inside.astype(np.int8), -reach, cell, shell, notes)

    def signs(self, points: Float64[np.ndarray, "n 3"]) -> Int8[np.ndarray, " n"]:
        """+1, −1 or 0 (unknown): the labels of the cells that points of the box lie in."""
        top = len(self.labels) - 1
        index = np.clip(((points - self.lower) / self.cell).astype(np.int64), 0, top)
        return self.labels[tuple(index.T)]

    def signed_distance(self, points: Float64[np.ndarray, "n 3"]) -> Float32[np.ndarray, " n"]:
        """Distance to the nearest point of the cloud with the cell's sign; NaN where nothing is certain."""
        return self.told(points)[0]

    def told(
        self, points: Float64[np.ndarray, "n 3"]
    ) -> tuple[Float32[np.ndarray, " n"], Int64[np.ndarray, " n"]]:
        """The signed distance, and the number of the nearest point; NaN and −1 where nothing is certain.

        A cell's label need not hold in all of the cell, so a point must itself keep CLEARANCE from the cloud.
        """
        signs = self.signs(points)
        labelled = np.flatnonzero(signs)
        gap, found = self.tree.query(points[labelled], workers=-1)
        clear = gap > CLEARANCE * self.shell
        certain = labelled[clear]
        distance = np.full(len(points), np.nan, dtype=np.float32)
        nearest = np.full(len(points), -1, dtype=np.int64)
        distance[certain], nearest[certain] = signs[certain] * gap[clear], found[clear]
        return distance, nearest

    @property
    def known_inside(self) -> float:
        """Fraction of the grid known to be inside."""
        return float(np.mean(self.labels < 0))


def grid_distance(
    points: Float64[np.ndarray, "n 3"], tree: KDTree, count: int, reach: float, cell: float, shell: float
) -> Float32[np.ndarray, "a b c"]:
    """Distance from cell centres to the cloud: exact where it decides about the shell, else to a cell."""
    occupied = np.zeros((count, count, count), dtype=bool)
    occupied[tuple(np.clip(((points + reach) / cell).astype(np.int64), 0, count - 1).T)] = True
    distance = gaps(occupied, cell)
    middle, half = 0.5 * (1.0 + CLEARANCE) * shell, 0.5 * (1.0 - CLEARANCE) * shell
    near = np.abs(distance - middle) < half + np.sqrt(0.75) * cell
    centres = cell * (np.argwhere(near) + 0.5) - reach
    distance[near] = tree.query(centres, workers=-1)[0]
    return distance


def gaps(marked: Bool[np.ndarray, "a b c"], cell: float) -> Float32[np.ndarray, "a b c"]:
    """Distance of every cell's centre to the nearest marked cell's, up to TOLD cells; beyond, more than that.

    The square of it, in cells, is the least over shifts along one axis after the other: a tenth of the time
    of a distance transform without a limit.
    """
    squared = np.where(marked, np.uint8(0), np.uint8(BEYOND))
    for axis in range(3):
        line = np.moveaxis(squared, axis, 0)
        before = line.copy()
        for shift in range(1, TOLD + 1):
            further = before + np.uint8(shift * shift)
            np.minimum(line[shift:], further[:-shift], out=line[shift:])
            np.minimum(line[:-shift], further[shift:], out=line[:-shift])
    return np.sqrt(squared, dtype=np.float32) * np.float32(cell)


def connected(free: Bool[np.ndarray, "a b c"]) -> Int32[np.ndarray, "a b c"]:
    """Rooms of free cells that touch across faces, numbered from 1; OUTSIDE is the one at the boundary."""
    rooms = np.empty(tuple(side + 2 for side in free.shape), dtype=np.int32)
    label(np.pad(free, 1, constant_values=True), output=rooms)
    return rooms[1:-1, 1:-1, 1:-1]


def enclosed(
    rooms: Int32[np.ndarray, "a b c"],
    distance: Float32[np.ndarray, "a b c"],
    shell: float,
    cell: float,
) -> Bool[np.ndarray, "a b c"]:
    """Cells of the rooms that are inside: closed to a thinner shell, and against the outside."""
    leaky = rooms[connected(distance > THIN_SHELL * shell) == OUTSIDE]
    beside = gaps(rooms == OUTSIDE, cell) < 2.0 * shell + 1.8 * cell
    inside = np.zeros(int(rooms.max()) + 1, dtype=bool)
    inside[rooms[beside]] = True
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

"""The cases of marching cubes, made by rule rather than copied from a table.

Corner c of a cell has offset (c & 1, c >> 1 & 1, c >> 2 & 1). Edge 4a + b + 2d runs along axis a at offset
b on axis a+1 and d on axis a+2 (cyclic). Face 2a + s is the side s of axis a.

On every face the crossings are joined by directed segments; a face with four crossings is ambiguous and
has two ways: its inside corners apart, or joined. The segments of six faces close to loops, and loops are
cut into triangles; a loop that cannot be cut without an inner edge between two crossings of one face (it
then winds around a saddle) gets a fan around a vertex in the cell, at most one a cell. Two cells that
share a face see the same segments, each used once from either side, so every edge of the mesh has exactly
two triangles, whatever the signs are.

The choice on an ambiguous face is the asymptotic decider of Nielson & Hamann, *The asymptotic decider:
resolving the ambiguity in marching cubes* (1991); a tunnel through a cell is never made.
"""

import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int8, Int32

CENTRE = 12
CORNERS = np.array([(c & 1, c >> 1 & 1, c >> 2 & 1) for c in range(8)], dtype=np.int32)


def _edges() -> list[tuple[int, int]]:
    """The two corners of each of the twelve edges, lower one first."""
    pairs = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for d, b in itertools.product((0, 1), repeat=2):
            low = (b << u) | (d << v)
            pairs.append((low, low | 1 << axis))
    return pairs


def _faces() -> list[list[int]]:
    """The four corners of each of the six faces, counter-clockwise seen from outside the cell."""
    rings = []
    for axis in range(3):
        u, v = 1 << (axis + 1) % 3, 1 << (axis + 2) % 3
        rings.append([0, v, u | v, u])
        rings.append([corner | 1 << axis for corner in (0, u, u | v, v)])
    return rings


EDGES = np.array(_edges(), dtype=np.int32)
FACES = np.array(_faces(), dtype=np.int32)
START = np.append(EDGES[:, 0], 0)
END = np.append(EDGES[:, 1], 0)
AXIS = np.append(np.repeat(np.arange(3), 4), 3)


@dataclass(frozen=True)
class Cases:
    """Triangles of case (inside corners) | (joined faces) << 8: rows start[case] … + count[case]."""

    start: Int32[np.ndarray, " 16384"]
    count: Int32[np.ndarray, " 16384"]
    triangles: Int8[np.ndarray, "t 3"]


@dataclass(frozen=True)
class Loops:
    """The loops of every case, numbered from 0.

    count: how many. of: the loop that an edge belongs to, -1 where the edge is not crossed. after: the edge
    that follows it there.
    """

    count: Int8[np.ndarray, " 16384"]
    of: Int8[np.ndarray, "16384 12"]
    after: Int8[np.ndarray, "16384 12"]


@functools.cache
def cases() -> Cases:
    """All cases; triangles are three edge numbers, CENTRE being the vertex in the cell.

    Counter-clockwise seen from outside, where the field is positive.
    """
    start = np.zeros(1 << 14, dtype=np.int32)
    count = np.zeros(1 << 14, dtype=np.int32)
    triangles: list[tuple[int, int, int]] = []
    for case, case_loops in _every_case():
        rows = [row for loop in case_loops for row in _triangulation(tuple(loop))]
        start[case] = len(triangles)
        count[case] = len(rows)
        triangles += rows
    return Cases(start, count, np.array(triangles, dtype=np.int8))


@functools.cache
def loops() -> Loops:
    """The loops of all cases, each run through clockwise seen from outside."""
    count = np.zeros(1 << 14, dtype=np.int8)
    of, after = (np.full((1 << 14, 12), -1, dtype=np.int8) for _ in range(2))
    for case, case_loops in _every_case():
        count[case] = len(case_loops)
        for number, loop in enumerate(case_loops):
            of[case, loop] = number
            after[case, loop] = [*loop[1:], loop[0]]
    return Loops(count, of, after)


def _every_case() -> Iterator[tuple[int, list[list[int]]]]:
    """Every case that occurs, with its loops."""
    for inside in range(256):
        ambiguous = [face for face in range(6) if _pattern(inside, face) in ((1, 0, 1, 0), (0, 1, 0, 1))]
        for choice in itertools.product((0, 1), repeat=len(ambiguous)):
            joined = sum(bit << face for bit, face in zip(choice, ambiguous, strict=True))
            yield inside | joined << 8, _loops(inside, joined)


def _pattern(inside: int, face: int) -> tuple[int, ...]:
    return tuple(inside >> int(corner) & 1 for corner in FACES[face])


def _loops(inside: int, joined: int) -> list[list[int]]:
    """The closed loops of edge numbers along which the surface meets the cell's faces."""
    number = {frozenset(pair): edge for edge, pair in enumerate(_edges())}
    following: dict[int, int] = {}
    for face, ring in enumerate(_faces()):
        bits = _pattern(inside, face)
        for i in range(4):
            if bits[i] and not bits[(i + 1) % 4]:
                turn = 1 if joined >> face & 1 else -1
                j = (i + turn) % 4
                while bits[j] or not bits[(j + 1) % 4]:
                    j = (j + turn) % 4
                leave = number[frozenset((ring[i], ring[(i + 1) % 4]))]
                following[leave] = number[frozenset((ring[j], ring[(j + 1) % 4]))]
    loops = []
    while following:
        loop = [min(following)]
        while (edge := following.pop(loop[-1])) != loop[0]:
            loop.append(edge)
        loops.append(loop)
    return loops


def _triangulation(loop: tuple[int, ...]) -> list[tuple[int, int, int]]:
    """A loop cut into triangles without an inner edge between two edges of one face."""
    rows = _cut(loop)
    if rows is not None:
        return rows
    return [(loop[i], loop[i - 1], CENTRE) for i in range(len(loop))]


def _cut(loop: tuple[int, ...]) -> list[tuple[int, int, int]] | None:
    if len(loop) == 3:
        return [(loop[0], loop[2], loop[1])]
    first, last = loop[0], loop[-1]
    for i in range(1, len(loop) - 1):
        parts: list[tuple[int, int, int]] = [(first, last, loop[i])]
        for side in (loop[: i + 1], loop[i:]):
            if len(side) == 2:
                continue
            rest = None if _share_face(side[0], side[-1]) else _cut(side)
            if rest is None:
                break
            parts += rest
        else:
            return parts
    return None


@functools.cache
def _share_face(one: int, other: int) -> bool:
    corners = set(EDGES[one].tolist()) | set(EDGES[other].tolist())
    return any(corners <= set(ring) for ring in _faces())

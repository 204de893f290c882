"""A mesh for the view in 3D: few triangles, quantised, deflated, as text that stands in the page.

Bytes before deflation, all of them planes: what changes slowly lies together and packs well.

    x, y, z of the vertices      2 bytes each, differences to the vertex before, zigzag, low bytes first
    a; b − a; c − a of the faces 3 bytes each, a as difference to the face before, zigzag
    level of the vertices        1 byte each, place on the colour map; only where there is one

zigzag: 0, −1, 1, −2 … become 0, 1, 2, 3 …. A plane of k-byte numbers: all lowest bytes, then all next ones.
"""

import base64
import zlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64, UInt8

from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.report.refine import Levels, Points, refined
from weingarten.report.simplify import simplified

STEPS = 2**15 - 1
"""Positions are whole steps, so many along the mesh's longest side."""
TRIANGLES = 12_000
ALL_TRIANGLES = 1_600_000
FEWEST = 1_500
TRUTHS_SHARE = 1.5
"""A truth's scene may have so many times the triangles of a mesh's, for it is coloured by every contender."""
SHAPE, TRUTHS_SHAPE = 0.8, 0.4
"""Shares of the triangles that the shape gets, of meshes and of truths; the rest is for the colours."""


@dataclass(frozen=True)
class Scene:
    """vertices, faces: counts. low, step: position = low + whole number × step. data: base64, deflated."""

    vertices: int
    faces: int
    low: tuple[float, float, float]
    step: float
    data: str


@dataclass(frozen=True)
class Slim:
    """A mesh of few triangles, vertices in the order of their first use. levels: by vertex and colouring."""

    mesh: Mesh
    levels: UInt8[np.ndarray, "_ k"]


def triangles_each(parts: int, contenders: int) -> int:
    """How many triangles a contender's scene may have, so that a page of so many of them stays small."""
    shares = parts * (contenders + TRUTHS_SHARE)
    return max(FEWEST, min(TRIANGLES, int(ALL_TRIANGLES / max(shares, 1))))


def slim(mesh: Mesh, most: int, shape: float, levels_at: Callable[[Points], Levels]) -> Slim:
    """The mesh with about `most` triangles at most, of which the share `shape` is for the shape alone."""
    mesh, levels = refined(simplified(mesh, int(shape * most)), most, levels_at)
    ordered, order = by_use(mesh)
    return Slim(ordered, as_bytes(levels[order]))


def by_use(mesh: Mesh) -> tuple[Mesh, Int64[np.ndarray, " v"]]:
    """The same with its vertices in the order of their first use, which packs well; which each one was."""
    used, first, inverse = np.unique(mesh.faces.reshape(-1), return_index=True, return_inverse=True)
    by_first = np.argsort(first)
    rank = np.empty(len(used), dtype=np.int64)
    rank[by_first] = np.arange(len(used))
    order = used[by_first]
    return Mesh(mesh.vertices[order], rank[inverse].reshape(-1, 3)), order


def uncoloured(points: Points) -> Levels:
    """No level of any place."""
    return np.zeros((len(points), 0))


def as_bytes(levels: Levels) -> UInt8[np.ndarray, "_ k"]:
    """Rounded, from 0 to 255."""
    return np.round(np.clip(levels, 0.0, 255.0)).astype(np.uint8)


def scene(mesh: Mesh, frame: Frame, levels: UInt8[np.ndarray, " v"] | None = None) -> Scene:
    """A slim mesh, packed; positions in the unit frame of `frame`. levels: of its vertices."""
    low, step, content = place_planes(frame.to_unit(mesh.vertices))
    content += face_planes(mesh) + (b"" if levels is None else levels.tobytes())
    return Scene(len(mesh.vertices), len(mesh.faces), low, step, packed(content))


def place_planes(points: Points) -> tuple[tuple[float, float, float], float, bytes]:
    """low, step (see Scene) and the planes of positions."""
    low = points.min(axis=0)
    step = max(float((points.max(axis=0) - low).max()) / STEPS, 1e-12)
    steps = np.round((points - low) / step).astype(np.int64)
    x, y, z = (float(f"{value:.7g}") for value in low)
    return (x, y, z), float(f"{step:.7g}"), b"".join(difference_plane(axis, 2) for axis in steps.T)


def face_planes(mesh: Mesh) -> bytes:
    """The planes of faces."""
    a, b, c = mesh.faces.T
    return difference_plane(a, 3) + _plane(_zigzag(b - a), 3) + _plane(_zigzag(c - a), 3)


def difference_plane(values: Int64[np.ndarray, " n"], size: int) -> bytes:
    """Differences to the number before, zigzag; `size` bytes each."""
    return _plane(_zigzag(np.diff(values, prepend=0)), size)


def packed(content: bytes) -> str:
    """Bytes, deflated (RFC 1950), as base64."""
    return base64.b64encode(zlib.compress(content, 9)).decode("ascii")


def _zigzag(values: Int64[np.ndarray, " n"]) -> Int64[np.ndarray, " n"]:
    return np.where(values < 0, -2 * values - 1, 2 * values)


def _plane(values: Int64[np.ndarray, " n"], size: int) -> bytes:
    return b"".join((values >> 8 * k & 255).astype(np.uint8).tobytes() for k in range(size))

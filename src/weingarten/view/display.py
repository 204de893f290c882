"""Meshes and clouds as a browser can turn them: few triangles, none of them large, few points."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from weingarten.errors import MissingExtraError
from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.report.refine import cut, edges_of
from weingarten.report.scene import by_use
from weingarten.report.simplify import simplified

Points = Float64[np.ndarray, "_ 3"]

TRIANGLES, POINTS = 60_000, 60_000
"""Shown at most, before large triangles are cut."""

LONGEST = 0.02
"""Edges are cut until they are no longer, in lengths of the part's longest side: colours are interpolated
between vertices, and a flat face has none but at its edges."""

ROUNDS, FULL = 8, 2.5
"""Times that all edges are looked at; how many times the triangles there may be afterwards."""

COARSEST, CELLS = 16, 4.0
"""Cells along the longest side of the coarsest clustering; how many cells a triangle is worth."""


@dataclass(frozen=True)
class Displayed:
    """mesh: world frame. whole: triangles of what it stands for.

    simpler: whether some of its shape was left out. clustered: for want of a better way.
    """

    mesh: Mesh
    whole: int
    simpler: bool
    clustered: bool

    @property
    def note(self) -> str:
        """What was left out, in a sentence; empty where nothing was."""
        if not self.simpler:
            return ""
        advice = "" if not self.clustered else '; install "weingarten[report]" for a truer shape'
        return f"Drawn with {len(self.mesh.faces):,} triangles in place of {self.whole:,}{advice}."


def displayed(mesh: Mesh, most: int = TRIANGLES) -> Displayed:
    """The mesh with about `most` triangles for its shape, its large ones cut, packed well."""
    small, clusters = mesh, False
    if len(mesh.faces) > most:
        try:
            small = simplified(mesh, most)
        except MissingExtraError:
            small, clusters = clustered(mesh, most), True
    return Displayed(by_use(finer(small, int(FULL * most)))[0], len(mesh.faces), small is not mesh, clusters)


def finer(mesh: Mesh, most: int) -> Mesh:
    """The same surface with edges that are at most LONGEST, or with about `most` triangles."""
    longest = LONGEST * float(np.ptp(mesh.vertices, axis=0).max())
    for _ in range(ROUNDS):
        pairs, which = edges_of(mesh)
        length = np.linalg.norm(mesh.vertices[pairs[:, 1]] - mesh.vertices[pairs[:, 0]], axis=1)
        cuts = length > longest
        if not cuts.any() or len(mesh.faces) + 2 * np.count_nonzero(cuts) > most:
            break
        mesh = cut(mesh, pairs, which, cuts, np.full(len(pairs), 0.5))
    return mesh


def clustered(mesh: Mesh, most: int) -> Mesh:
    """Vertices in one cubic cell become their mean (Rossignac and Borrel 1993), until triangles are few."""
    frame = Frame.of(mesh.vertices)
    unit = frame.to_unit(mesh.vertices)
    cells = max(COARSEST, int(np.sqrt(most * CELLS)))
    while True:
        _, cell = np.unique(np.floor(unit * cells / 2).astype(np.int64), axis=0, return_inverse=True)
        cell = cell.reshape(-1)
        faces = cell[mesh.faces]
        whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
        if np.count_nonzero(whole) <= most or cells <= COARSEST:
            break
        cells = max(COARSEST, int(0.8 * cells))
    count = np.bincount(cell)[:, None]
    sums = np.stack([np.bincount(cell, weights=axis) for axis in unit.T], axis=1)
    return Mesh(frame.to_world(sums / count), faces[whole])


def few(points: Points, most: int = POINTS) -> Points:
    """At most so many of the points, evenly picked from their order."""
    return points[:: max(1, -(-len(points) // most))]

"""The cells through which the zero set passes: what every mesher makes its mesh of."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int, Int32, Int64

from weingarten.surface.cases import FACES
from weingarten.surface.lattice import Lattice

_LEAST_SHARE = 1e-3
"""Vertices keep this share of an edge from its nodes, so that single precision cannot merge two of them."""


@dataclass(frozen=True)
class Cells:
    """All cells that have corners of both signs.

    corners: numbers of their nodes, in the order of `cases.CORNERS`. nodes: places on the lattice. values: of
    the field at these.
    """

    corners: Int32[np.ndarray, "n 8"]
    nodes: Int32[np.ndarray, "v 3"]
    values: Float32[np.ndarray, " v"]
    lattice: Lattice

    @property
    def case(self) -> Int[np.ndarray, " n"]:
        """The case of every cell; see `case_of`."""
        return case_of(self.values[self.corners])

    def shares(self, start: Int[np.ndarray, " e"], end: Int[np.ndarray, " e"]) -> Float64[np.ndarray, " e"]:
        """How far along lattice edges between two nodes of both signs the linear interpolant is zero."""
        first, last = self.values[start].astype(np.float64), self.values[end].astype(np.float64)
        return (first / (first - last)).clip(_LEAST_SHARE, 1.0 - _LEAST_SHARE)


def case_of(values: Float32[np.ndarray, "n 8"]) -> Int[np.ndarray, " n"]:
    """Case of every cell: bit c for an inside corner c, bit 8 + face for a face whose insides are joined.

    On an ambiguous face the bilinear interpolant has a saddle; it is inside where the product of the two
    inside values exceeds that of the two outside ones.
    """
    inside = values < 0
    case = (inside << np.arange(8)).sum(axis=1)
    for face, (a, b, c, d) in enumerate(FACES):
        alike = (inside[:, a] == inside[:, c]) & (inside[:, b] == inside[:, d])
        at = np.nonzero(alike & (inside[:, a] != inside[:, b]))[0]
        corner = values[at].astype(np.float64)
        product, other = corner[:, a] * corner[:, c], corner[:, b] * corner[:, d]
        joined = np.where(inside[at, a], product > other, other > product)
        case[at] |= joined << (8 + face)
    return case


def numbered(
    keys: Int[np.ndarray, "*n"], limit: int
) -> tuple[Int[np.ndarray, " v"], Int64[np.ndarray, "*n"]]:
    """The different keys in ascending order, and the number of each key among them."""
    used = np.zeros(limit, dtype=bool)
    used[keys] = True
    unique = np.nonzero(used)[0]
    number = np.empty(limit, dtype=np.int32)
    number[unique] = np.arange(len(unique), dtype=np.int32)
    return unique, number[keys].astype(np.int64)

"""Which lattice nodes have to be evaluated: from a coarse lattice down to the surface, then along it.

A field with ‖∇f‖ ≤ L that is f(p) at p lies in f(p) ± L·‖x − p‖ at x. So the values at the corners of a
cell bound those at its 27 half-way nodes; a cell whose bounds leave no room for a zero is dropped, nodes
whose sign is sure are not evaluated, and the rest goes one level down (stride s → s/2).

L is 1.1 times the 99th percentile of ‖∇f‖ at the coarse nodes nearest to the surface, so no scale of f is
assumed. It is an estimate. What makes the result closed is the flood at the end: every lattice edge with a
change of sign gets its two ends evaluated and the sign of every node of its four cells, repeated until
nothing is missing. An L that is too small can therefore never cut a surface open; it can only miss a
component, or a tip, that is thinner than the coarse lattice and touches none of its sign changes.
"""

from collections.abc import Callable, Iterator

import numpy as np
import torch
from jaxtyping import Float, Float32, Int
from torch import Tensor

from weingarten.errors import ExtractionError
from weingarten.surface.bricks import Bricks
from weingarten.surface.lattice import Lattice

Values = Callable[[Float[Tensor, "n 3"]], Float[Tensor, " n"]]

COARSE_CELLS = 32
SAFETY = 1.1
NUDGE = 1e-6
MARGIN = 0.5
_PROBES = 2048
_CHUNK = 1 << 17
_HALVES = [np.array(offset, dtype=np.int32) for offset in np.ndindex(3, 3, 3)]
_CORNERS = [np.array(offset, dtype=np.int32) for offset in np.ndindex(2, 2, 2)]


class Octree:
    """The field g = max(f, −L·depth) at the lattice nodes near its zero set: f, closed at the box.

    bricks: an interval for every node looked at; |g| < 1e-6·h is stored as +1e-6·h.
    slope: the bound L on ‖∇f‖, field units per unit of length.
    evaluations: calls of the field so far, counted in points.
    """

    def __init__(self, values: Values, lattice: Lattice, batch: int) -> None:
        self.lattice = lattice
        self.evaluations = 0
        self.slope = 0.0
        self._values = values
        self._batch = batch
        self._highest = -np.inf
        self._stride = 1
        while 2 * self._stride * COARSE_CELLS <= max(lattice.cells):
            self._stride *= 2
        x, y, z = (-(-count // self._stride) for count in lattice.cells)
        self._counts = (x, y, z)
        self.bricks = Bricks((x + 1, y + 1, z + 1))

    def refine(self) -> None:
        """Fill the bricks. Raises ExtractionError where the field never changes sign, or is not finite."""
        x, y, z = self._counts
        nodes = _grid((x + 1, y + 1, z + 1))
        field = self._field(self.lattice.positions(nodes * self._stride))
        self.slope = self._bound(nodes * self._stride, field)
        self._store(nodes, field)
        cells = _grid(self._counts)
        while self._stride > 1:
            cells = self._halved(cells)
        self._flood()

    def _field(self, positions: Float[np.ndarray, "n 3"]) -> Float32[np.ndarray, " n"]:
        """The field at positions in the unit frame, in batches."""
        points = torch.from_numpy(positions.astype(np.float32))
        with torch.no_grad():
            parts = [self._values(part).to(torch.float32).cpu() for part in points.split(self._batch)]
        self.evaluations += len(positions)
        field = torch.cat(parts).numpy()
        if not np.isfinite(field).all():
            raise ExtractionError("The field is not finite everywhere in the box: the fit has diverged.")
        return field

    def _bound(self, nodes: Int[np.ndarray, "n 3"], field: Float32[np.ndarray, " n"]) -> float:
        """L, from central differences over one cell at the coarse nodes with the smallest |f|.

        The median step between coarse nodes is the least it can be: a field of plateaus is no constant.
        """
        x, y, z = self._counts
        block = field.reshape(x + 1, y + 1, z + 1)
        near = np.argsort(np.abs(field), kind="stable")[:_PROBES]
        centre, half = self.lattice.positions(nodes[near]), 0.5 * self.lattice.step
        shifted = [centre + sign * half * axis for axis in np.eye(3) for sign in (1.0, -1.0)]
        ends = self._field(np.concatenate(shifted)).reshape(3, 2, -1).astype(np.float64)
        gradient = (ends[:, 0] - ends[:, 1]) / self.lattice.step
        steps = [np.median(np.abs(np.diff(block, axis=axis))) for axis in range(3)]
        least = float(max(steps)) / (self._stride * self.lattice.step)
        return SAFETY * max(least, float(np.quantile(np.linalg.norm(gradient, axis=0), 0.99)))

    def _store(self, nodes: Int[np.ndarray, "n 3"], field: Float32[np.ndarray, " n"]) -> None:
        """Store g at nodes of the present stride."""
        depth = self.lattice.depths(nodes * self._stride)
        self._highest = max(self._highest, float(field[depth >= 0].max(initial=-np.inf)))
        closed = np.maximum(field, self._cap(depth))
        small = np.float32(NUDGE * self.lattice.step)
        closed[np.abs(closed) < small] = small
        self.bricks.assign(self.bricks.locate(nodes), closed)

    def _evaluate(self, nodes: Int[np.ndarray, "n 3"]) -> None:
        for start in range(0, len(nodes), _CHUNK):
            part = nodes[start : start + _CHUNK]
            self._store(part, self._field(self.lattice.positions(part * self._stride)))

    def _cap(self, depth: Int[np.ndarray, " n"]) -> Float32[np.ndarray, " n"]:
        """−L·depth, the field of the box itself, which g never falls below; just above 0 on its sides."""
        step, small = self.lattice.step, np.float32(NUDGE * self.lattice.step)
        cap = (-self.slope * step * depth).astype(np.float32)
        return np.where(depth <= 0, np.maximum(cap, small), cap)

    def _halved(self, cells: Int[np.ndarray, "n 3"]) -> Int[np.ndarray, "m 3"]:
        """The cells of half the stride in which a zero can lie; evaluates the nodes that need it."""
        coarse = self.bricks
        x, y, z = self._counts
        self._counts = (2 * x, 2 * y, 2 * z)
        self._stride //= 2
        self.bricks = Bricks((2 * x + 1, 2 * y + 1, 2 * z + 1))
        chunks = range(0, len(cells), _CHUNK)
        kept = np.concatenate([self._kept(coarse, cells[start : start + _CHUNK]) for start in chunks])
        self._evaluate(self._doubtful())
        return np.concatenate([2 * kept + corner for corner in _CORNERS])

    def _kept(self, coarse: Bricks, cells: Int[np.ndarray, "n 3"]) -> Int[np.ndarray, "m 3"]:
        """The cells that may hold a zero; stores the bounds at their 27 half-way nodes.

        In a dropped cell every lattice node has the same sure sign: it is at most room from one of the 27.
        """
        corners = [coarse.find(cells + corner) for corner in _CORNERS]
        lows = np.stack([coarse.low[corner] for corner in corners])
        highs = np.stack([coarse.high[corner] for corner in corners])
        depth = [self.lattice.depths((2 * cells + offset) * self._stride) for offset in _HALVES]
        bounds = [self._between(lows, highs, *pair) for pair in zip(_HALVES, depth, strict=True)]
        room = 0.5 * np.sqrt(3.0) * self._reach if self._stride > 1 else 0.0
        lowest = np.minimum.reduce([low for low, _ in bounds])
        highest = np.maximum.reduce([high for _, high in bounds])
        keep = np.nonzero((lowest > room) == (highest < -room))[0]
        for offset, (low, high) in zip(_HALVES, bounds, strict=True):
            at = self.bricks.locate(2 * cells[keep] + offset)
            self.bricks.low[at] = np.maximum(self.bricks.low[at], low[keep])
            self.bricks.high[at] = np.minimum(self.bricks.high[at], high[keep])
        return cells[keep]

    @property
    def _reach(self) -> float:
        """How far the field can change over one edge of the present stride."""
        return self.slope * self.lattice.step * self._stride

    def _between(
        self,
        lows: Float32[np.ndarray, "8 n"],
        highs: Float32[np.ndarray, "8 n"],
        offset: Int[np.ndarray, " 3"],
        depth: Int[np.ndarray, " n"],
    ) -> tuple[Float32[np.ndarray, " n"], Float32[np.ndarray, " n"]]:
        """Bounds at one of the 27 half-way nodes of every cell, from those at the nearest of its corners."""
        distance = np.array([float(np.linalg.norm(offset - 2 * corner)) for corner in _CORNERS])
        near = np.nonzero(distance == distance.min())[0]
        low, high = lows[near].max(axis=0), highs[near].min(axis=0)
        if len(near) == 1:
            return low, high
        reach = np.float32(self._reach * distance.min())
        low -= reach
        high += reach
        cap = self._cap(depth)
        return np.maximum(low, cap), np.maximum(high, cap)

    def _doubtful(self) -> Int[np.ndarray, "n 3"]:
        """The stored nodes without a value whose bounds are too wide to go on with."""
        room = MARGIN * self._reach if self._stride > 1 else 0.0
        low, high = self.bricks.low, self.bricks.high
        stored = np.isfinite(low) | np.isfinite(high)
        doubtful = stored & (low != high) & ((low > room) == (high < -room))
        return self.bricks.nodes(np.nonzero(doubtful)[0])

    def _flood(self) -> None:
        """Evaluate along the zero set until every sign change has all it needs for a closed surface."""
        edges = self._crossings()
        if not len(edges) or self._highest <= 0:
            sign = "negative" if self._highest <= 0 else "positive"
            raise ExtractionError(
                f"The field is {sign} everywhere in the box, so there is no surface to extract: fit longer, "
                "or check that the box holds the part."
            )
        while len(edges):
            nodes = self._wanted(edges)
            before = self.bricks.signs(nodes)
            self._evaluate(nodes)
            edges = self._crossings_at(nodes[self.bricks.signs(nodes) != before])

    def _crossings(self) -> Int[np.ndarray, "n 4"]:
        """Every lattice edge with a change of sign: its lower node and its axis."""
        found = [np.empty((0, 4), dtype=np.int32)]
        for first, signs in self.bricks.padded_signs():
            for axis, (low, high) in enumerate(_pairs(signs)):
                brick, x, y, z = np.nonzero(low * high < 0)
                node = first[brick] + np.stack([x, y, z], axis=1).astype(np.int32)
                found.append(_with_axis(node, axis))
        return np.concatenate(found)

    def _crossings_at(self, nodes: Int[np.ndarray, "n 3"]) -> Int[np.ndarray, "m 4"]:
        """The lattice edges with a change of sign that end at the nodes."""
        found = [np.empty((0, 4), dtype=np.int32)]
        signs = self.bricks.signs(nodes)
        for axis in range(3):
            for side in (-1, 1):
                other = nodes.copy()
                other[:, axis] += side
                inside = (other[:, axis] >= 0) & (other[:, axis] <= self.lattice.cells[axis])
                changed = np.zeros(len(nodes), dtype=bool)
                changed[inside] = signs[inside] * self.bricks.signs(other[inside]) < 0
                found.append(_with_axis(np.minimum(nodes, other)[changed], axis))
        return np.concatenate(found)

    def _wanted(self, edges: Int[np.ndarray, "n 4"]) -> Int[np.ndarray, "m 3"]:
        """Ends of the edges without a value and nodes of their four cells without a sign."""
        wanted = [np.empty(0, dtype=np.int32)]
        for axis in range(3):
            low = edges[edges[:, 3] == axis, :3]
            for along, u, v in np.ndindex(2, 3, 3):
                offset = np.roll(np.array([along, u - 1, v - 1], dtype=np.int32), axis)
                at = self.bricks.locate(low + offset)
                if (u, v) == (1, 1):
                    wanted.append(at[~self.bricks.exact(at)])
                else:
                    wanted.append(at[(self.bricks.low[at] > 0) == (self.bricks.high[at] < 0)])
        marks = np.zeros(len(self.bricks.low), dtype=bool)
        marks[np.concatenate(wanted)] = True
        return self.bricks.nodes(np.nonzero(marks)[0])


def _grid(counts: tuple[int, int, int]) -> Int[np.ndarray, "n 3"]:
    x, y, z = np.indices(counts, dtype=np.int32)
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


def _with_axis(nodes: Int[np.ndarray, "n 3"], axis: int) -> Int[np.ndarray, "n 4"]:
    return np.concatenate([nodes, np.full((len(nodes), 1), axis, dtype=np.int32)], axis=1)


def _pairs(signs: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The signs at the lower and upper ends of the 8³ edges of each axis that start in a brick."""
    own = signs[:, :-1, :-1, :-1]
    yield own, signs[:, 1:, :-1, :-1]
    yield own, signs[:, :-1, 1:, :-1]
    yield own, signs[:, :-1, :-1, 1:]

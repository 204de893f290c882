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

from collections.abc import Callable

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32, Int, Int32
from torch import Tensor

from weingarten.crew import Crew
from weingarten.errors import ExtractionError
from weingarten.surface import flood
from weingarten.surface.axes import Axes
from weingarten.surface.bounds import PARITIES, halfway, interleaved, least, of_cells
from weingarten.surface.bricks import SIDE, VOLUME, Bricks
from weingarten.surface.lattice import Lattice

Values = Callable[[Float[Tensor, "n 3"]], Float[Tensor, " n"]]

COARSE_CELLS = 32
SAFETY = 1.1
NUDGE = 1e-6
MARGIN = 0.5
_PROBES = 2048
_CHUNK = 1 << 17
PIECE, GPU_PIECE = 512, 1 << 13
"""Bricks that are worked on together: few enough that they stay in a core's cache."""


class Octree:
    """The field g = max(f, −L·depth) at the lattice nodes near its zero set: f, closed at the box.

    Everything is kept on the device that the field's values come from.

    bricks: bounds for every node looked at; |g| < 1e-6·h is stored as +1e-6·h.
    piece: bricks that are worked on together.
    slope: the bound L on ‖∇f‖, field units per unit of length.
    evaluations: calls of the field so far, counted in points.
    """

    def __init__(self, values: Values, lattice: Lattice, batch: int, crew: Crew) -> None:
        self.lattice = lattice
        self.evaluations = 0
        self.slope = 0.0
        self._values = values
        self._batch = batch
        self._crew = crew
        self._highest = -np.inf
        self._small = NUDGE * lattice.step
        self._stride = 1
        while 2 * self._stride * COARSE_CELLS <= max(lattice.cells):
            self._stride *= 2
        x, y, z = (-(-count // self._stride) for count in lattice.cells)
        self._counts = (x, y, z)

    def refine(self) -> None:
        """Fill the bricks. Raises ExtractionError where the field never changes sign, or is not finite."""
        with torch.no_grad(), self._crew:
            cells = self._begun()
            while self._stride > 1:
                cells = self._halved(cells)
            self._flood()

    def _begun(self) -> Int32[Tensor, " n"]:
        """Evaluate the coarse nodes; the addresses of all coarse cells."""
        x, y, z = self._counts
        grid = _grid((x + 1, y + 1, z + 1)) * self._stride
        field = self._field(torch.from_numpy(self.lattice.positions(grid).astype(np.float32)))
        self._device = field.device
        self.piece = PIECE if field.device.type == "cpu" else GPU_PIECE
        self.slope = self._bound(grid, field.cpu().numpy())
        longest = (max(self._counts) + 4 * SIDE) * self._stride
        self._axes = Axes(self.lattice, self.slope, self._small, longest, self._device)
        self.bricks = Bricks((x + 1, y + 1, z + 1), self._device)
        nodes = torch.from_numpy(grid.T // self._stride).to(self._device)
        self.bricks.cover(nodes)
        self.bricks.grow()
        addresses = self.bricks.find(nodes)
        self._store(addresses, nodes * self._stride, field)
        return self.bricks.find(torch.from_numpy(_grid(self._counts).T.copy()).to(self._device))

    def _field(self, points: Float32[Tensor, "n 3"]) -> Float32[Tensor, " n"]:
        """The field at positions in the unit frame, in batches."""
        field = torch.cat([self._values(part).to(torch.float32) for part in points.split(self._batch)])
        self.evaluations += len(points)
        if not torch.isfinite(field).all():
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
        ends = self._field(torch.from_numpy(np.concatenate(shifted).astype(np.float32)))
        ends = ends.cpu().numpy().reshape(3, 2, -1).astype(np.float64)
        gradient = (ends[:, 0] - ends[:, 1]) / self.lattice.step
        steps = [np.median(np.abs(np.diff(block, axis=axis))) for axis in range(3)]
        least = float(max(steps)) / (self._stride * self.lattice.step)
        return SAFETY * max(least, float(np.quantile(np.linalg.norm(gradient, axis=0), 0.99)))

    def _store(
        self, addresses: Int32[Tensor, " n"], nodes: Int32[Tensor, "3 n"], field: Float32[Tensor, " n"]
    ) -> None:
        """Store g at nodes of stride 1."""
        x, y, z = self.lattice.cells
        within = (nodes[0] <= x) & (nodes[1] <= y) & (nodes[2] <= z)
        self._highest = max(self._highest, float(field.where(within, -torch.inf).max()))
        closed = field.maximum(self._axes.box(nodes))
        closed[closed.abs() < self._small] = self._small
        self.bricks.assign(addresses, closed)

    def _evaluate(self, addresses: Int32[Tensor, " n"]) -> None:
        for part in addresses.split(self._batch):
            if len(part):
                nodes = self.bricks.nodes(part) * self._stride
                self._store(part, nodes, self._field(self._axes.positions(nodes)))

    def _halved(self, cells: Int32[Tensor, " n"]) -> Int32[Tensor, " m"]:
        """The cells of half the stride in which a zero can lie; evaluates the nodes that need it."""
        coarse = self.bricks
        x, y, z = self._counts
        self._counts = (2 * x, 2 * y, 2 * z)
        self._stride //= 2
        self.bricks = Bricks((2 * x + 1, 2 * y + 1, 2 * z + 1), self._device)
        flags = self._doubted(coarse, cells)
        kept = []
        for part in cells.split(_CHUNK):
            kept.append(part[flags[part]])
            self.bricks.cover_cells(2 * coarse.nodes(kept[-1]))
        cells = torch.cat(kept)
        flags.zero_()
        flags[cells] = True
        self.bricks.grow()
        pieces = self.bricks.slots(self.piece)
        doubtful = self._crew.map(lambda slots: self._filled(coarse, flags, slots), pieces)
        self._evaluate(torch.cat(doubtful))
        first = self.bricks.find(2 * coarse.nodes(cells))
        return torch.cat([first + (x << 6 | y << 3 | z) for x, y, z in PARITIES])

    def _doubted(self, coarse: Bricks, cells: Int32[Tensor, " n"]) -> Bool[Tensor, " a"]:
        """By address, the coarse cells that may hold a zero, and others that are not asked for.

        In one that holds none every lattice node has the same sure sign: it is at most room from one of the
        cell's 27 half-way nodes.
        """
        room = 0.5 * np.sqrt(3.0) * self._reach if self._stride > 1 else 0.0
        flags = torch.zeros(len(coarse), SIDE, SIDE, SIDE, dtype=torch.bool, device=self._device)

        def look(slots: Int32[Tensor, " b"]) -> None:
            firsts = coarse.firsts(slots)
            bounds = halfway(coarse.at(coarse.block(firsts, SIDE + 1)), SIDE + 1, self._reach)
            for parity, part in zip(PARITIES[1:], bounds[1:], strict=True):
                offset = torch.tensor(parity, dtype=torch.int32, device=self._device)[:, None]
                self._close(part, 2 * firsts + offset, SIDE + 1, 2)
            low, negative = least(bounds, SIDE + 1)
            doubted = (low > room) == (negative > room)
            flags[slots] = doubted.view(-1, SIDE + 1, SIDE + 1, SIDE + 1)[:, :SIDE, :SIDE, :SIDE]

        used = torch.zeros(len(coarse), dtype=torch.bool, device=self._device)
        used[cells >> 9] = True
        # blocks of 9³ nodes take more room than those of 5³
        self._crew.map(look, used.nonzero().squeeze(1).to(torch.int32).split(self.piece // 2))
        return flags.view(-1)

    @property
    def _reach(self) -> float:
        """How far the field can change over one edge of the present stride."""
        return self.slope * self.lattice.step * self._stride

    def _close(
        self, bounds: Float32[Tensor, "2 n"], firsts: Int32[Tensor, "3 b"], side: int, every: int
    ) -> None:
        """Raise what is known at every other node, or each, of blocks to the field of the box."""
        box = self._axes.box_of_blocks(firsts * self._stride, side, every * self._stride).view(-1)
        low, negative = bounds
        torch.maximum(low, box.where(low > -torch.inf, -torch.inf), out=low)
        torch.minimum(negative, box.neg_(), out=negative)

    def _filled(
        self, coarse: Bricks, cells: Bool[Tensor, " a"], slots: Int32[Tensor, " b"]
    ) -> Int32[Tensor, " n"]:
        """Store the bounds at nodes of the cells, in some bricks; the nodes where they are too wide to go on.

        cells: by address, the coarse cells that may hold a zero.
        """
        side, firsts = SIDE // 2 + 1, self.bricks.firsts(slots)
        bounds = halfway(coarse.at(coarse.block(firsts // 2, side)), side, self._reach)
        inside = of_cells(cells[coarse.block(firsts // 2 - 1, side)], side)
        bounds = [part.where(own, -torch.inf) for part, own in zip(bounds, inside, strict=True)]
        found = interleaved(bounds, side).view(2, -1)
        self._close(found, firsts, SIDE, 1)
        self.bricks.bounds.view(2, -1, VOLUME)[:, slots] = found.view(2, -1, VOLUME)
        low, negative = found
        room = MARGIN * self._reach if self._stride > 1 else 0.0
        doubtful = ((low > room) == (negative > room)) & (low != -negative)
        doubtful &= (low > -torch.inf) | (negative > -torch.inf)
        at = doubtful.nonzero().squeeze(1)
        return slots[at >> 9] << 9 | (at & VOLUME - 1).to(torch.int32)

    def _flood(self) -> None:
        """Evaluate along the zero set until every sign change has all it needs for a closed surface."""
        some, ends, edges = flood.crossings(self.bricks, self._crew, self.piece)
        if not some or self._highest <= 0:
            sign = "negative" if self._highest <= 0 else "positive"
            raise ExtractionError(
                f"The field is {sign} everywhere in the box, so there is no surface to extract: fit longer, "
                "or check that the box holds the part."
            )
        while len(ends) or any(axis.shape[1] for axis in edges):
            addresses = flood.wanted(self.bricks, ends, edges)
            before = self.bricks.sides(addresses)
            self._evaluate(addresses)
            changed = addresses[self.bricks.sides(addresses) != before]
            ends, edges = ends[:0], flood.crossings_at(self.bricks, self.bricks.nodes(changed))


def _grid(counts: tuple[int, int, int]) -> Int[np.ndarray, "n 3"]:
    x, y, z = np.indices(counts, dtype=np.int32)
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)

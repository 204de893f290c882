"""A step's points, cut into pieces, and a piece's way through the crew."""

import functools
import itertools
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from threading import Lock

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.evaluation import Evaluation
from weingarten.calculus.jet import GRADIENT, HESSIAN, TANGENT, VALUE, Jet
from weingarten.crew import Crew
from weingarten.fit.optimiser import Factor
from weingarten.scan.sample import Sample
from weingarten.terms.term import Term

LEAST = 300
"""Arithmetic of a piece at least, in forward passes of one point, where there is a choice."""

WHOLE = 32
"""A leg's points are a multiple of this, so that the products' columns are."""

Begin = Callable[[Tensor, int, Tensor], Evaluation]
"""Points, order and angles to an evaluation."""

PASSES = {VALUE: 3, GRADIENT: 6, TANGENT: 12, HESSIAN: 15}
"""Forward passes that a point's jet and its derivative cost."""


@dataclass(frozen=True)
class Part:
    """Drawn points of one domain, taken at `order` for `terms`."""

    sample: Sample
    order: int
    terms: tuple[Term, ...]

    def split(self, sizes: list[int]) -> "list[Part]":
        """Consecutive parts of these sizes."""
        ends = list(itertools.accumulate(sizes))
        rows = [slice(end - size, end) for size, end in zip(sizes, ends, strict=True)]
        return [replace(self, sample=self.sample[row]) for row in rows]


def cut(parts: list[Part], crew: int, chunk: int) -> list[list[Part]]:
    """Pieces, of the highest order first: parts of one order laid end to end and cut equally.

    A piece is shared by the crew, or one's alone: a handful of points stays together, since a leg has a price
    of its own. The pieces, and with them the last bits of the sums over them, are those of this size of the
    crew.
    """
    pieces: list[list[Part]] = []
    for order in sorted({part.order for part in parts}, reverse=True):
        row = [part for part in parts if part.order == order]
        count = sum(len(part.sample) for part in row)
        number = -(-count // (chunk * hands(order, count, crew)))
        pieces += between(row, [count * (i + 1) // number for i in range(number)])
    return pieces


def hands(order: int, count: int, crew: int) -> int:
    """How many of the crew share so many points of this order."""
    return crew if PASSES[order] * count >= crew * LEAST else 1


def between(row: list[Part], ends: list[int]) -> list[list[Part]]:
    """Parts laid end to end, cut at `ends`."""
    borders = itertools.accumulate((len(part.sample) for part in row), initial=0)
    pieces: list[list[Part]] = [[] for _ in ends]
    for part, first in zip(row, borders, strict=False):
        last = first + len(part.sample)
        spans = [(max(first, a), min(last, b)) for a, b in itertools.pairwise([0, *ends])]
        sizes = [max(0, b - a) for a, b in spans]
        for piece, fragment in zip(pieces, part.split(sizes), strict=True):
            if len(fragment.sample):
                piece.append(fragment)
    return pieces


class Piece:
    """Parts of one order on their way through the crew: their jet, the terms, and back to the gradient.

    A leg of it a core, there and back; whoever of the crew brings the last leg of the jet evaluates the
    terms, at the desk. Then totals: the sums of its residuals, and gradient: of its part of the loss, laid
    end to end.
    """

    totals: dict[Term, Tensor]
    gradient: Float[Tensor, " w"]

    def __init__(self, parts: list[Part], begin: Begin, shares: Mapping[Term, Factor], crew: Crew) -> None:
        self.parts, self.begin, self.shares, self.crew = parts, begin, shares, crew
        self.lock = Lock()

    def send(self, then: Callable[[], None]) -> None:
        """Set out; `then` is called at the end."""
        self.then = then
        order = self.parts[0].order
        points = torch.cat([part.sample.points for part in self.parts])
        angles = torch.cat([part.sample.turns for part in self.parts])
        share = -(-len(points) // hands(order, len(points), self.crew.size))
        self.size = -(-share // WHOLE) * WHOLE
        rows = zip(points.split(self.size), angles.split(self.size), strict=True)
        self.legs = [self.begin(own, order, turns) for own, turns in rows]
        self.all([leg.forward for leg in self.legs], self.turn)

    def all(self, jobs: list[Callable[[], None]], then: Callable[[], None]) -> None:
        """Have the crew do the jobs, and the one who does the last of them, `then`."""
        self.left = len(jobs)
        for job in jobs:
            self.crew.begin(functools.partial(self.one, job, then))

    def one(self, job: Callable[[], None], then: Callable[[], None]) -> None:
        """Do a job, and `then` where no other is left."""
        job()
        with self.lock:
            self.left -= 1
            last = self.left == 0
        if last:
            with self.crew.desk:
                then()

    def turn(self) -> None:
        """Sum the residuals, and send their cotangents back."""
        leaves = joined([leg.jet() for leg in self.legs])
        totals: dict[Term, Tensor] = {}
        losses: list[Tensor] = []
        with torch.enable_grad():
            jets = leaves.split([len(part.sample) for part in self.parts])
            for part, jet in zip(self.parts, jets, strict=True):
                for term in part.terms:
                    total = term.residual(jet, part.sample).sum(0)
                    losses.append(self.shares[term] * total)
                    totals[term] = totals.get(term, 0.0) + total.detach()
            bars = torch.autograd.grad(torch.stack(losses).sum(), leaves.tensors, allow_unused=True)
        self.totals = totals
        split = [[None] * len(self.legs) if bar is None else bar.split(self.size) for bar in bars]
        for leg, own in zip(self.legs, zip(*split, strict=True), strict=True):
            leg.pull(own)
        self.all([leg.backward for leg in self.legs], self.gather)

    def gather(self) -> None:
        """Add the legs' gradients, and let the next piece set out."""
        self.gradient = functools.reduce(torch.Tensor.add_, [leg.gradient() for leg in self.legs])
        self.legs.clear()
        self.then()


def through(crew: Crew, pieces: Sequence[Piece], together: int) -> None:
    """Send pieces through the crew, so many of them at a time."""
    waiting = deque(pieces)
    with crew.desk:
        for _ in range(together):
            send_next(waiting)
    crew.finish()


def send_next(waiting: deque[Piece]) -> None:
    """Send the first of those that wait, if any does, and the one behind it when it has come to its end."""
    if waiting:
        waiting.popleft().send(functools.partial(send_next, waiting))


def joined(jets: list[Jet]) -> Jet:
    """The jets of consecutive points as one, whose tensors are leaves of a graph of their own."""
    tensors = [torch.cat(row) for row in zip(*(jet.tensors for jet in jets), strict=True)]
    return Jet(*(tensor.detach().requires_grad_() for tensor in tensors))


def cost(parts: list[Part]) -> int:
    """Arithmetic, in forward passes of one point."""
    return sum(PASSES[part.order] * len(part.sample) for part in parts)

"""A step's points, cut into pieces that are evaluated at once."""

import itertools
from dataclasses import dataclass, replace

from weingarten.calculus.jet import GRADIENT, TANGENT, VALUE
from weingarten.scan.sample import Sample
from weingarten.terms.term import Term

LEAST = 1000
"""Arithmetic of a piece at least, in forward passes of one point, where there is a choice."""

PASSES = {VALUE: 3, GRADIENT: 6, TANGENT: 12}
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
    """Pieces to evaluate at once, the dearest first: parts of one order laid end to end and cut equally.

    As many as a whole number for every one of the crew, so that none waits long for another; a handful of
    points stays together, since a piece has a price of its own. The pieces, and with them the last bits of
    the sums over them, are those of this size of the crew.
    """
    pieces: list[list[Part]] = []
    for order in sorted({part.order for part in parts}, reverse=True):
        row = [part for part in parts if part.order == order]
        count = sum(len(part.sample) for part in row)
        shared = PASSES[order] * count >= crew * LEAST
        number = min(count, crew * -(-count // (crew * chunk))) if shared else -(-count // chunk)
        ends = [count * (i + 1) // number for i in range(number)]
        pieces += between(row, ends)
    return sorted(pieces, key=cost, reverse=True)


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


def cost(parts: list[Part]) -> int:
    """Arithmetic, in forward passes of one point."""
    return sum(PASSES[part.order] * len(part.sample) for part in parts)

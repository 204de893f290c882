"""The optimisation: knows no method, no ground truth, no file's format.

A step evaluates each domain once, in pieces that stay in a processor's cache, at the highest order that a
term on it asks for; each piece's loss is differentiated at once, so memory does not grow with the points.
Every core of the crew works on a piece of its own.
"""

import dataclasses
import functools
import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.jet import GRADIENT, TANGENT, VALUE, Calculus
from weingarten.crew import Crew
from weingarten.fit.optimisers import Optimiser, Rate
from weingarten.methods import Method
from weingarten.scan.draws import Draws
from weingarten.scan.sample import Sample
from weingarten.terms.term import Term

CHUNK, GPU_CHUNK = 2048, 65536
"""Points a piece at most: on a CPU enough for the products and few enough for the cache, on a GPU many."""

STAGES = 6
"""Sizes that a step's draws take on along the ramp."""

LEAST = 1000
"""Arithmetic of a piece at least, in forward passes of one point, where there is a choice."""

PASSES = {VALUE: 3, GRADIENT: 6, TANGENT: 12}
"""Forward passes that a point's jet and its derivative cost."""


@dataclass(frozen=True)
class Record:
    """One step as the loss curve has it: means of the residuals, unweighted, and the weights at that step.

    A term whose weight is zero and whose derivatives no other term needs is not evaluated: its mean is NaN.
    """

    step: int
    progress: float
    rate: float
    weights: dict[str, float]
    terms: dict[str, float]

    @property
    def loss(self) -> float:
        """Σ weight · mean residual."""
        weighed = (
            self.weights[name] * value for name, value in self.terms.items() if self.weights[name] > 0.0
        )
        return sum(weighed, 0.0)


@dataclass(frozen=True)
class Part:
    """Points of one domain, taken at `order`. shares: each term's weight over the number of its points."""

    sample: Sample
    angles: Float[Tensor, " n"]
    order: int
    shares: dict[Term, float]

    def split(self, sizes: list[int]) -> "list[Part]":
        """Consecutive parts of these sizes."""
        ends = list(itertools.accumulate(sizes))
        rows = [slice(end - size, end) for size, end in zip(sizes, ends, strict=True)]
        return [replace(self, sample=self.sample[row], angles=self.angles[row]) for row in rows]


@dataclass
class Loop:
    """All that a fit needs to take one more step.

    Raises nothing of its own; a loss that is not finite is left to the caller to see in the record.
    """

    field: nn.Module
    method: Method
    draws: Draws
    generator: torch.Generator
    optimisers: list[Optimiser]
    rate: Rate
    base_rate: float
    steps: int
    points: int
    clip: float
    ramp: tuple[float, float] = (1.0, 1.0)
    chunk: int = CHUNK
    crew: Crew = dataclasses.field(default_factory=Crew)
    step: int = 0
    calculus: Calculus = dataclasses.field(init=False)
    parameters: list[nn.Parameter] = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        self.calculus = self.method.calculus(self.field)
        self.parameters = list(self.field.parameters())
        self.device = self.parameters[0].device

    def advance(self) -> Record:
        """Take one step and say what it saw."""
        progress = self.step / self.steps
        rate = self.base_rate * self.rate(self.step, self.steps)
        self.field.zero_grad()
        means = self.accumulate(progress)
        torch.nn.utils.clip_grad_norm_(self.field.parameters(), self.clip)
        for optimiser in self.optimisers:
            optimiser.step(rate)
        named = {term.name: weight for term, weight in self.weights(progress).items()}
        record = Record(self.step, progress, rate, named, means)
        self.step += 1
        return record

    def weights(self, progress: float) -> dict[Term, float]:
        """Of all terms."""
        return {term: schedule(progress) for term, schedule in self.method.terms.items()}

    def count(self, progress: float) -> int:
        """Points of each domain: few at first, when any show the way, many when only the noise is left.

        In stages, since every new size costs the matrix library some milliseconds and some memory.
        """
        first, last = self.ramp
        stage = min(STAGES - 1, int(progress * STAGES)) / (STAGES - 1)
        return max(1, round(self.points * (first + (last - first) * stage)))

    def accumulate(self, progress: float) -> dict[str, float]:
        """Add the loss's gradient at `progress` to the field's and return each term's mean residual."""
        parts, counts = self.plan(progress)
        pieces = cut(parts, self.crew.size, self.chunk)
        seen = {term: sum(len(part.sample) for part in parts if term in part.shares) for term in counts}
        sums: dict[Term, Tensor | float] = dict.fromkeys(counts, 0.0)
        gradients: list[Tensor] = []
        for totals, gradient in self.crew.map(self.differentiated, pieces):
            gradients.append(gradient)
            for term, total in totals.items():
                sums[term] = sums[term] + total
        if gradients:
            self.receive(functools.reduce(torch.Tensor.add_, gradients))
        whole = {term: count if seen[term] == count else float("nan") for term, count in counts.items()}
        return {term.name: float(total) / whole[term] for term, total in sums.items()}

    def plan(self, progress: float) -> tuple[list[Part], dict[Term, int]]:
        """Fresh draws as they are to be evaluated, and how many points every term is a mean of."""
        weights = self.weights(progress)
        drawn = self.draws(self.count(progress), self.generator)
        samples = {name: sample.to(self.device) for name, sample in drawn.items()}
        counts = {
            term: sum(term.taken(name, len(samples[name])) for name in term.domains) for term in weights
        }
        shares = {term: weight / counts[term] for term, weight in weights.items()}
        parts = [part for name, sample in samples.items() for part in self.parts(name, sample, shares)]
        return parts, counts

    def parts(self, domain: str, sample: Sample, shares: dict[Term, float]) -> list[Part]:
        """A domain's sample, cut where a term's share of it ends."""
        angles = 2.0 * torch.pi * torch.rand(len(sample), generator=self.generator).to(self.device)
        terms = {term: term.taken(domain, len(sample)) for term in shares if domain in term.domains}
        found: list[Part] = []
        start = 0
        for end in sorted({count for term, count in terms.items() if shares[term] > 0.0}):
            reaching = [term for term, count in terms.items() if count >= end]
            order = max(term.order for term in reaching if shares[term] > 0.0)
            known = {term: shares[term] for term in reaching if term.order <= order}
            found.append(Part(sample[start:end], angles[start:end], order, known))
            start = end
        return found

    def receive(self, gradient: Float[Tensor, " w"]) -> None:
        """Add the gradient of all weights, laid end to end, to each one's own."""
        sizes = [weight.numel() for weight in self.parameters]
        for weight, own in zip(self.parameters, gradient.split(sizes), strict=True):
            weight.grad = own.view_as(weight) if weight.grad is None else weight.grad + own.view_as(weight)

    def differentiated(self, piece: list[Part]) -> tuple[dict[Term, Tensor], Float[Tensor, " w"]]:
        """A piece's sums of residuals, and the gradient of its part of the loss, laid end to end."""
        points = torch.cat([part.sample.points for part in piece])
        jet = self.calculus(points, piece[0].order, torch.cat([part.angles for part in piece]))
        totals: dict[Term, Tensor] = {}
        losses: list[Tensor] = []
        for part, own in zip(piece, jet.split([len(part.sample) for part in piece]), strict=True):
            for term, share in part.shares.items():
                total = term.residual(own, part.sample).sum()
                losses.append(share * total)
                totals[term] = totals.get(term, 0.0) + total.detach()
        gradients = torch.autograd.grad(
            torch.stack(losses).sum(), self.parameters, allow_unused=True, materialize_grads=True
        )
        return totals, torch.cat([gradient.reshape(-1) for gradient in gradients])


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
        number = crew * -(-count // (crew * chunk)) if shared else -(-count // chunk)
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


def run(loop: Loop, each: Callable[[Record, float], None], stop: Callable[[], bool] = lambda: False) -> bool:
    """Step until the end or until `stop()`; `each` gets every record and its seconds. True if finished."""
    with loop.crew:
        while loop.step < loop.steps:
            if stop():
                return False
            started = time.perf_counter()
            record = loop.advance()
            each(record, time.perf_counter() - started)
    return True

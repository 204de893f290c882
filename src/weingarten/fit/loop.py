"""The optimisation: knows no method, no ground truth, no file's format.

A step evaluates each domain once, in pieces that stay in a processor's cache, at the highest order that a
term on it asks for; each piece's loss is differentiated at once, so memory does not grow with the points.
Every core of the crew works on a piece of its own.
"""

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.jet import Calculus
from weingarten.crew import Crew
from weingarten.fit.optimisers import Optimiser, Rate
from weingarten.methods import Method
from weingarten.scan.draws import Draws
from weingarten.scan.sample import Sample
from weingarten.terms.term import Term

CHUNK, GPU_CHUNK = 1024, 65536
"""Points a piece at most: on a CPU enough for the products and few enough for the cache, on a GPU many."""


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
    chunk: int = CHUNK
    crew: Crew = dataclasses.field(default_factory=Crew)
    step: int = 0
    calculus: Calculus = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        self.calculus = self.method.calculus(self.field)
        self.device = next(self.field.parameters()).device

    def advance(self) -> Record:
        """Take one step and say what it saw."""
        progress = self.step / self.steps
        rate = self.base_rate * self.rate(self.step, self.steps)
        weights = {term: schedule(progress) for term, schedule in self.method.terms.items()}
        self.field.zero_grad()
        means = self.accumulate(weights)
        torch.nn.utils.clip_grad_norm_(self.field.parameters(), self.clip)
        for optimiser in self.optimisers:
            optimiser.step(rate)
        named = {term.name: weight for term, weight in weights.items()}
        record = Record(self.step, progress, rate, named, means)
        self.step += 1
        return record

    def accumulate(self, weights: dict[Term, float]) -> dict[str, float]:
        """Add the loss's gradient to the field's and return each term's mean residual."""
        samples = {name: s.to(self.device) for name, s in self.draws(self.points, self.generator).items()}
        counts = {term: sum(term.taken(len(samples[name])) for name in term.domains) for term in weights}
        shares = {term: weight / counts[term] for term, weight in weights.items()}
        pieces = [piece for name, sample in samples.items() for piece in self.pieces(name, sample, shares)]
        seen = {term: sum(len(p.sample) for p in pieces if term in p.shares) for term in weights}
        sums: dict[Term, Tensor | float] = dict.fromkeys(weights, 0.0)
        for totals, gradients in self.crew.map(self.differentiated, pieces):
            for term, total in totals.items():
                sums[term] = sums[term] + total
            for weight, gradient in zip(self.field.parameters(), gradients, strict=True):
                weight.grad = gradient if weight.grad is None else weight.grad.add_(gradient)
        whole = {term: count if seen[term] == count else float("nan") for term, count in counts.items()}
        return {term.name: float(total) / whole[term] for term, total in sums.items()}

    def pieces(self, domain: str, sample: Sample, shares: dict[Term, float]) -> "list[Piece]":
        """A domain's sample, cut where a term's share of it ends and into equal pieces of at most a chunk."""
        angles = 2.0 * torch.pi * torch.rand(len(sample), generator=self.generator).to(self.device)
        terms = {term: term.taken(len(sample)) for term in shares if domain in term.domains}
        found: list[Piece] = []
        start = 0
        for end in sorted({count for term, count in terms.items() if shares[term] > 0.0}):
            reaching = [term for term, count in terms.items() if count >= end]
            order = max(term.order for term in reaching if shares[term] > 0.0)
            known = {term: shares[term] for term in reaching if term.order <= order}
            size = -(-(end - start) // -(-(end - start) // self.chunk))
            pairs = zip(sample[start:end].split(size), angles[start:end].split(size), strict=True)
            found += [Piece(part, turn, order, known) for part, turn in pairs]
            start = end
        return found

    def differentiated(self, piece: "Piece") -> tuple[dict[Term, Tensor], tuple[Tensor, ...]]:
        """This piece's sums of residuals, and the gradient of its part of the loss."""
        jet = self.calculus(piece.sample.points, piece.order, piece.angles)
        totals = {term: term.residual(jet, piece.sample).sum() for term in piece.shares}
        loss = torch.stack([share * totals[term] for term, share in piece.shares.items()]).sum()
        gradients = torch.autograd.grad(
            loss, list(self.field.parameters()), allow_unused=True, materialize_grads=True
        )
        return {term: total.detach() for term, total in totals.items()}, gradients


@dataclass(frozen=True)
class Piece:
    """Points evaluated together, at `order`. shares: each term's weight over the number of its points."""

    sample: Sample
    angles: Float[Tensor, " n"]
    order: int
    shares: dict[Term, float]


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

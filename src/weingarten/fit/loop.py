"""The optimisation: knows no method, no ground truth, no file's format.

A step evaluates each domain once, in pieces that stay in the processor's cache, at the highest order that a
term on it asks for; each piece's loss is differentiated at once, so memory does not grow with the points.
"""

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from weingarten.calculus.jet import Calculus
from weingarten.fit.optimisers import Rate
from weingarten.methods import Method
from weingarten.scan.draws import Draws
from weingarten.scan.sample import Sample
from weingarten.terms.term import Term

CHUNK, GPU_CHUNK = 2048, 65536
"""Points a piece: on a CPU enough for the matrix products and few enough for the cache, on a GPU many."""


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
    optimisers: list[torch.optim.Optimizer]
    rate: Rate
    base_rate: float
    steps: int
    points: int
    clip: float
    chunk: int = CHUNK
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
        for optimiser in self.optimisers:
            optimiser.zero_grad(set_to_none=False)
            for group in optimiser.param_groups:
                group["lr"] = rate
        means = self.accumulate(weights)
        torch.nn.utils.clip_grad_norm_(self.field.parameters(), self.clip)
        for optimiser in self.optimisers:
            optimiser.step()
        named = {term.name: weight for term, weight in weights.items()}
        record = Record(self.step, progress, rate, named, means)
        self.step += 1
        return record

    def accumulate(self, weights: dict[Term, float]) -> dict[str, float]:
        """Add the loss's gradient to the field's and return each term's mean residual."""
        samples = {name: s.to(self.device) for name, s in self.draws(self.points, self.generator).items()}
        counts = {term: sum(len(samples[name]) for name in term.domains) for term in weights}
        sums: dict[Term, Tensor | float] = dict.fromkeys(weights, 0.0)
        for name, sample in samples.items():
            terms = [term for term in weights if name in term.domains]
            angles = 2.0 * torch.pi * torch.rand(len(sample), generator=self.generator)
            order = max((term.order for term in terms if weights[term] > 0.0), default=0)
            for term in terms:
                if term.order > order:
                    sums[term] = float("nan")
            terms = [term for term in terms if term.order <= order]
            if not terms:
                continue
            pieces = zip(sample.split(self.chunk), angles.to(self.device).split(self.chunk), strict=True)
            for piece, turn in pieces:
                loss = self.piece_loss(piece, turn, order, terms, weights, counts, sums)
                loss.backward()
        return {term.name: float(total) / counts[term] for term, total in sums.items()}

    def piece_loss(
        self,
        piece: Sample,
        angles: torch.Tensor,
        order: int,
        terms: list[Term],
        weights: dict[Term, float],
        counts: dict[Term, int],
        sums: dict[Term, Tensor | float],
    ) -> torch.Tensor:
        """This piece's share of the loss; adds its residuals to `sums`."""
        jet = self.calculus(piece.points, order, angles)
        loss = torch.zeros((), device=self.device)
        for term in terms:
            total = term.residual(jet, piece).sum()
            sums[term] = sums[term] + total.detach()
            loss = loss + (weights[term] / counts[term]) * total
        return loss


def run(loop: Loop, each: Callable[[Record, float], None], stop: Callable[[], bool] = lambda: False) -> bool:
    """Step until the end or until `stop()`; `each` gets every record and its seconds. True if finished."""
    while loop.step < loop.steps:
        if stop():
            return False
        started = time.perf_counter()
        record = loop.advance()
        each(record, time.perf_counter() - started)
    return True

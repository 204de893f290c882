"""The optimisation: knows no method, no ground truth, no file's format.

A step evaluates each domain once, in pieces, at the highest order that a term on it asks for; each piece's
loss is differentiated as soon as its jet is there, so memory does not grow with the points. The parts of an
ensemble step together: whatever is said here of the points, the loss or the gradient holds for each part by
itself.
"""

import dataclasses
import functools
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.evaluation import Evaluation, Staged, Taped
from weingarten.calculus.jet import Calculus, Progressive
from weingarten.crew import Crew
from weingarten.fields.ensemble import members
from weingarten.fit.clip import clip
from weingarten.fit.optimiser import Factor, Optimiser
from weingarten.fit.optimisers import Rate
from weingarten.fit.outline import Outline
from weingarten.fit.pieces import Part, Piece, cut, through
from weingarten.method import Method
from weingarten.scan.draws import Draws
from weingarten.scan.generators import Generators
from weingarten.schedules.adaptive import Adaptive
from weingarten.schedules.seen import Seen
from weingarten.terms.term import Term

CHUNK, GPU_CHUNK = 1280, 65536
"""Points of a leg, about, at most: on a CPU enough for the products and few for the cache, on a GPU many."""

TOGETHER = 2
"""Pieces on their way at a time: more than one, that nobody waits; few, for each holds memory."""

STAGES = 6
"""Sizes that a step's draws take on along the ramp."""


@dataclass(frozen=True)
class Record:
    """One step as the loss curve has it: means of the residuals, unweighted, and the weights at that step.

    A term whose weight is zero and whose derivatives no other term needs is not evaluated: its mean is NaN.
    member: which part of an ensemble.
    """

    step: int
    progress: float
    rate: float
    weights: dict[str, float]
    terms: dict[str, float]
    member: int = 0

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

    seed, noise: what adaptive weights begin with (`weingarten.schedules.adaptive.Rule.begin`).

    Raises nothing of its own; a loss that is not finite is left to the caller to see in the record.
    """

    field: nn.Module
    method: Method
    draws: Draws
    generator: torch.Generator | Generators
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
    seed: int = 0
    noise: float = 0.0
    calculus: Calculus = dataclasses.field(init=False)
    parameters: list[nn.Parameter] = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        self.calculus = self.method.calculus(self.field)
        self.parameters = list(self.field.parameters())
        self.device = self.parameters[0].device
        self.members = members(self.field)
        self.schedules = {
            term: weight.begin(term.name, self.seed, self.noise) for term, weight in self.method.terms.items()
        }
        self.adaptive = {t.name: own for t, own in self.schedules.items() if isinstance(own, Adaptive)}
        self.moves = isinstance(self.calculus, Progressive) or any(term.moving for term in self.schedules)

    def advance(self) -> Record:
        """Take one step of one field and say what it saw."""
        (record,) = self.stride()
        return record

    def stride(self) -> list[Record]:
        """Take a step and say what every part saw."""
        shares, factors = self.numbers()
        gradients = self.gradients() if self.asked() else None
        sums = self.move(self.outline(self.progress), shares, factors)
        self.step += 1
        records = self.records(self.step - 1, sums)
        for own in self.adaptive.values():
            own.watch(Seen(records[0].progress, records[0].terms, records[0].weights, gradients))
        return records

    def asked(self) -> bool:
        """Whether an adaptive weight wants the terms' gradients at the step to come."""
        intervals = [own.gradients_every for own in self.adaptive.values()]
        return any(interval and self.step % interval == 0 for interval in intervals)

    def gradients(self) -> dict[str, float]:
        """‖∇_W L‖ of every active term's mean residual L, unweighted, at the draws of the step to come."""
        outline, state = self.outline(self.progress), self.generator.get_state()
        norms: dict[str, float] = {}
        for term in (term for term in outline.terms if term in outline.active):
            self.generator.set_state(state)
            self.field.zero_grad()
            alone = {other: float(other is term) / other.total(outline.count) for other in outline.terms}
            self.differentiate(dataclasses.replace(outline, active=frozenset({term})), alone)
            squares = [(w.grad * w.grad).sum() for w in self.parameters if w.grad is not None]
            norms[term.name] = float(torch.stack(squares).sum().sqrt())
        self.generator.set_state(state)
        return norms

    @property
    def progress(self) -> float:
        """Of the step to come."""
        return self.step / self.steps

    def numbers(self) -> tuple[dict[Term, float], list[tuple[float, ...]]]:
        """The shares of the step to come, and what each of the optimisers will multiply by."""
        rate = self.base_rate * self.rate(self.step, self.steps)
        return self.shares(self.progress), [optimiser.factors(rate) for optimiser in self.optimisers]

    def move(
        self, outline: Outline, shares: Mapping[Term, Factor], factors: Sequence[Sequence[Factor]]
    ) -> Float[Tensor, "terms *m"]:
        """Take one step; the sums of every term's residuals. Nothing in it asks the device for a value."""
        self.field.zero_grad()
        sums = self.differentiate(outline, shares)
        gradients = [weight.grad for weight in self.parameters if weight.grad is not None]
        clip(gradients, self.clip, len(self.members))
        for optimiser, own in zip(self.optimisers, factors, strict=True):
            for job in optimiser.jobs(*own):
                self.crew.begin(job)
        self.crew.finish()
        return sums

    def records(self, step: int, sums: Float[Tensor, "terms *m"]) -> list[Record]:
        """What every part saw at a step that gave these sums."""
        progress = step / self.steps
        rate = self.base_rate * self.rate(step, self.steps)
        named = {term.name: weight for term, weight in self.weights(progress).items()}
        means = self.means(self.outline(progress), sums)
        return [Record(step, progress, rate, named, own, member) for member, own in enumerate(means)]

    def weights(self, progress: float) -> dict[Term, float]:
        """Of all terms."""
        return {term: schedule(progress) for term, schedule in self.schedules.items()}

    def count(self, progress: float) -> int:
        """Points of each domain: few at first, when any show the way, many when only the noise is left.

        In stages, since every new size costs the matrix library some milliseconds and some memory.
        """
        first, last = self.ramp
        stage = min(STAGES - 1, int(progress * STAGES)) / (STAGES - 1)
        return max(1, round(self.points * (first + (last - first) * stage)))

    def outline(self, progress: float) -> Outline:
        """Of the step at `progress`."""
        active = frozenset(term for term, weight in self.weights(progress).items() if weight > 0.0)
        moment = progress if self.moves else 0.0
        return Outline(self.count(progress), tuple(self.method.terms), active, moment)

    def shares(self, progress: float) -> dict[Term, float]:
        """Each term's weight over the number of its points."""
        count = self.count(progress)
        return {term: weight / term.total(count) for term, weight in self.weights(progress).items()}

    def accumulate(self, progress: float) -> list[dict[str, float]]:
        """Add the loss's gradient at `progress` to the field's; every part's mean residuals, by term."""
        outline = self.outline(progress)
        return self.means(outline, self.differentiate(outline, self.shares(progress)))

    def differentiate(self, outline: Outline, shares: Mapping[Term, Factor]) -> Float[Tensor, "terms *m"]:
        """Add the loss's gradient at fresh draws to the field's; the sums of every term's residuals."""
        begin = functools.partial(self.begin, self.present(outline.progress))
        pieces = [Piece(parts, begin, shares, self.crew) for parts in self.pieces(outline)]
        through(self.crew, pieces, TOGETHER)
        sums = dict.fromkeys(self.method.terms, self.parameters[0].detach().new_zeros(self.members))
        for piece in pieces:
            for term, total in piece.totals.items():
                sums[term] = sums[term] + total
        gradients = [piece.gradient for piece in pieces]
        if gradients:
            self.receive(functools.reduce(torch.Tensor.add_, gradients))
        return torch.stack(list(sums.values()))

    def means(self, outline: Outline, sums: Float[Tensor, "terms *m"]) -> list[dict[str, float]]:
        """Every part's mean residuals, by term; NaN of a term that was not evaluated at all of its points."""
        counts = {term.name: count for term, count in outline.counts().items()}
        rows = sums.reshape(len(sums), -1).t().tolist()
        return [
            {name: total / count for (name, count), total in zip(counts.items(), row, strict=True)}
            for row in rows
        ]

    def plan(self, outline: Outline) -> list[Part]:
        """Fresh draws as they are to be evaluated."""
        drawn = self.draws(outline.count, self.generator)
        samples = {
            name: dataclasses.replace(sample.to(self.device), progress=outline.progress)
            for name, sample in drawn.items()
        }
        return [
            Part(samples[span.domain][span.start : span.end], span.order, span.terms)
            for span in outline.spans()
        ]

    def receive(self, gradient: Float[Tensor, " w"]) -> None:
        """Add the gradient of all weights, laid end to end, to that of each one that is to be moved."""
        sizes = [weight.numel() for weight in self.parameters]
        for weight, own in zip(self.parameters, gradient.split(sizes), strict=True):
            if not weight.requires_grad:
                continue
            weight.grad = own.view_as(weight) if weight.grad is None else weight.grad + own.view_as(weight)

    def pieces(self, outline: Outline) -> list[list[Part]]:
        """Fresh draws as they are evaluated."""
        chunk = max(1, self.chunk // math.prod(self.members))
        return cut(self.plan(outline), self.crew.size, chunk)

    def present(self, progress: float) -> Calculus:
        """The calculus of the step at `progress`."""
        return self.calculus.at(progress) if isinstance(self.calculus, Progressive) else self.calculus

    def begin(self, calculus: Calculus, points: Tensor, order: int, angles: Tensor) -> Evaluation:
        """A jet before it is worked out."""
        if isinstance(calculus, Staged):
            return calculus.begin(points, order, angles)
        return Taped(calculus, self.parameters, points, order, angles)


def run(loop: Loop, each: Callable[[Record, float], None], stop: Callable[[], bool] = lambda: False) -> bool:
    """Step until the end or until `stop()`, asked before every stride. True if finished.

    each: gets every record, and how many seconds its step took.
    """
    with loop.crew:
        while loop.step < loop.steps:
            if stop():
                return False
            started, first = time.perf_counter(), loop.step
            records = loop.stride()
            seconds = (time.perf_counter() - started) / (loop.step - first)
            for record in records:
                each(record, seconds)
    return True

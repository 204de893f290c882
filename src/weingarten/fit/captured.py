"""Steps that a GPU repeats by itself: recorded once, replayed without the interpreter (CUDA graphs).

A step of a narrow field is some hundreds of small operations; each takes the interpreter longer to ask for
than the GPU to do. All that changes from one step to the next, while the outline of the step stays the same,
are the random numbers, which the device draws, and a few factors, which are written into one small tensor
beforehand. What the steps saw stays on the device too, and is read back for several steps at once.
"""

import dataclasses
import functools
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.fit.loop import Loop, Record
from weingarten.fit.outline import Outline
from weingarten.scan.generators import Generators

READ_EVERY = 25
"""Steps between two readings; divides the oracle's interval, so that it sees the steps that it asks for."""

Work = Callable[[], Tensor]


@runtime_checkable
class Replay(Protocol):
    """A piece of work that is always the same, to be done again and again."""

    def __call__(self) -> Tensor:
        """Do it once more. What it returns is overwritten by the next call."""
        ...


class Graph:
    """A CUDA graph of some work: the second call records it, and from then on the GPU repeats it.

    The first call only does it, on a stream of its own, so that the libraries have prepared themselves.
    pool: of memory, for graphs that never run at the same time and need nothing of each other.
    """

    def __init__(self, work: Work, generators: list[torch.Generator], pool: Any) -> None:
        self.work, self.generators, self.pool = work, generators, pool
        self.graph: torch.cuda.CUDAGraph | None = None
        self.warm = False

    def __call__(self) -> Tensor:
        """See Replay."""
        if not self.warm:
            self.warm = True
            return self.rehearsed()
        if self.graph is None:
            self.record()
        assert self.graph is not None
        self.graph.replay()
        return self.output

    def rehearsed(self) -> Tensor:
        """The work, done as any other."""
        stream = torch.cuda.Stream()
        stream.wait_stream(torch.cuda.current_stream())
        with torch.cuda.stream(stream):
            output = self.work()
        torch.cuda.current_stream().wait_stream(stream)
        return output

    def record(self) -> None:
        """Have the work written down, without doing it."""
        self.graph = torch.cuda.CUDAGraph()
        for generator in self.generators:
            self.graph.register_generator_state(generator)
        with torch.cuda.graph(self.graph, pool=self.pool):
            self.output = self.work()


def recorder(generator: torch.Generator | Generators) -> Callable[[Work], Replay]:
    """What makes graphs of one loop's work, which draws with this generator."""
    generators = generator.members if isinstance(generator, Generators) else [generator]
    return functools.partial(Graph, generators=generators, pool=torch.cuda.graph_pool_handle())


@dataclass
class Captured(Loop):
    """A loop whose steps of one outline are one piece of work; a stride is of several steps.

    replay: makes the replay of some work. The work itself is one, on a device that cannot record.

    A graph reads and writes the same memory at every replay: weights, the optimisers' memory, the clouds and
    `dials` are made once and never replaced; all else is made and used up within a step. That holds for the
    scaled weights of `Analytic` too: the work ends with the weights moved, so that whenever it is run anew,
    it begins with working them out.
    """

    replay: Callable[[Work], Replay] = dataclasses.field(kw_only=True)
    replays: dict[Outline, Replay] = dataclasses.field(init=False, default_factory=dict)
    dials: Float[Tensor, " f"] = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.method.terms) + sum(optimiser.size for optimiser in self.optimisers)
        self.dials = next(self.field.parameters()).detach().new_zeros(count)

    def stride(self) -> list[Record]:
        """Take the steps up to the next reading and say what every part saw at each.

        One at a time where no step is like the one before, or a weight waits for what the last one saw.
        """
        if self.moves or self.adaptive:
            return super().stride()
        first = self.step
        last = min(self.steps, (first // READ_EVERY + 1) * READ_EVERY)
        sums: list[Tensor] = []
        while self.step < last:
            self.dial()
            sums.append(self.replayed(self.outline(self.progress))().clone())
            self.step += 1
        if self.step == self.steps:
            # they keep the loop, which keeps them, and the collector knows nothing of a device's memory
            self.replays.clear()
        read = torch.stack(sums).cpu()
        return [record for step, row in enumerate(read, first) for record in self.records(step, row)]

    def dial(self) -> None:
        """Send the numbers of the step to come to the device."""
        shares, factors = self.numbers()
        numbers = [*shares.values(), *itertools.chain(*factors)]
        self.dials.copy_(torch.tensor(numbers, dtype=self.dials.dtype), non_blocking=True)

    def replayed(self, outline: Outline) -> Replay:
        """The replay of the step with this outline."""
        if outline not in self.replays:
            numbers = iter(self.dials.unbind())
            shares = {term: next(numbers) for term in self.method.terms}
            factors = [list(itertools.islice(numbers, optimiser.size)) for optimiser in self.optimisers]
            self.replays[outline] = self.replay(functools.partial(self.move, outline, shares, factors))
        return self.replays[outline]

"""Who takes part in `step.py` and `methods.py`: a name for each, its row's label, and how to take its step.

All fit the bundled flange, 30,000 points. Torch is imported only when a contender is made.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from weingarten.settings import Settings

STANDARD_TURN = 10
"""Steps of the standard preset that are timed at once: one alone is short."""

SWEEP = 24
"""Steps of a whole standard fit that stand for all of it, evenly spread."""


@dataclass(frozen=True)
class Stepper:
    """step: takes one. crew: to be entered before. turn: steps to time at once. gigaflop: of a step."""

    step: Callable[[], object]
    crew: AbstractContextManager
    turn: int = 1
    gigaflop: float = 0.0


@dataclass(frozen=True)
class Contender:
    """A row of the table. stepper: from the number of points of each kind that a paper step takes."""

    label: str
    stepper: Callable[[int], Stepper]


def paper(method: str) -> Callable[[int], Stepper]:
    """The paper preset's step by one of the package's methods."""

    def stepper(points: int) -> Stepper:
        """With so many points of each kind."""
        from weingarten.settings import resolve

        return engine(resolve("paper", method=method, points=points), at=0, turn=1)

    return stepper


def standard(progress: float) -> Callable[[int], Stepper]:
    """The standard preset's step at a progress from 0, its first, to 1, its last."""

    def stepper(_: int) -> Stepper:
        """With the preset's own number of points."""
        from weingarten.settings import resolve

        settings = resolve("standard")
        return engine(settings, at=round(progress * (settings.steps - 1)), turn=STANDARD_TURN)

    return stepper


def sweep(method: str) -> Callable[[int], Stepper]:
    """A standard fit by one of the package's methods: SWEEP of its steps, in each of which a turn begins."""

    def stepper(_: int) -> Stepper:
        """With the preset's own number of points."""
        import torch

        from weingarten.reconstruction import prepared
        from weingarten.samples.parts import sample_part
        from weingarten.settings import resolve

        settings = resolve("standard", method=method)
        loop = prepared(sample_part("flange", 30_000, 0), settings, torch.device("cpu"))
        at = itertools.cycle(round((i + 0.5) / SWEEP * settings.steps) for i in range(SWEEP))

        def step() -> None:
            loop.step = next(at)
            loop.advance()

        return Stepper(step, loop.crew, SWEEP)

    return stepper


def engine(settings: Settings, at: int, turn: int) -> Stepper:
    """Step number `at` of a fit, over and over, as `weingarten fit` takes it; its arithmetic is counted."""
    import torch

    from weingarten.fit.pieces import cost
    from weingarten.reconstruction import prepared
    from weingarten.samples.parts import sample_part

    loop = prepared(sample_part("flange", 30_000, 0), settings, torch.device("cpu"))
    passes = cost(loop.plan(loop.outline(at / settings.steps)))
    multiplications = 3 * settings.width + (settings.depth - 1) * settings.width**2

    def step() -> None:
        loop.step = at
        loop.advance()

    return Stepper(step, loop.crew, turn, passes * 2e-9 * multiplications)


def plain(kind: str) -> Callable[[int], Stepper]:
    """The paper preset's step by a class of double_backward.py."""

    def stepper(points: int) -> Stepper:
        """With so many points of each kind, on the draws that the package's methods get."""
        import double_backward
        import torch

        from weingarten.reconstruction import prepared
        from weingarten.samples.parts import sample_part
        from weingarten.scan.sample import NEAR
        from weingarten.settings import resolve

        settings = resolve("paper", points=points)
        loop = prepared(sample_part("flange", 30_000, 0), settings, torch.device("cpu"))
        code = getattr(double_backward, kind)()

        def step() -> None:
            samples = loop.draws(points, loop.generator)
            code.step(*(sample.points for sample in samples.values()), samples[NEAR].turns, 10.0)

        return Stepper(step, nullcontext())

    return stepper


CONTENDERS = {
    "engine": Contender("this engine (odw-paper)", paper("odw-paper")),
    "stencil": Contender("finite differences (odw-paper-fd)", paper("odw-paper-fd")),
    "baseline": Contender("plain double backward, unchunked", plain("DoubleBackward")),
    "hessian": Contender("full Hessian by autograd, unchunked", plain("FullHessian")),
    "first": Contender("standard, first step", standard(0.0)),
    "last": Contender("standard, last step", standard(1.0)),
}
HEAVY = ("baseline", "hessian")
"""Those that need many gigabytes."""

FIT_OF = "fit:"
"""Before a method's name: the steps of a whole fit of the standard preset."""


def contender(name: str) -> Contender:
    """One of CONTENDERS, or a method's step of the paper preset, or after FIT_OF its whole standard fit."""
    if name.startswith(FIT_OF):
        return Contender(name, sweep(name.removeprefix(FIT_OF)))
    return CONTENDERS[name] if name in CONTENDERS else Contender(name, paper(name))

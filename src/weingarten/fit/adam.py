"""Adam (Kingma & Ba 2015, algorithm 1, with torch's defaults β = (0.9, 0.999), ε = 10⁻⁸).

    m ← β₁m + (1 − β₁)g,   v ← β₂v + (1 − β₂)g²,   w ← w − lr · (m / (1 − β₁ᵗ)) / (√(v / (1 − β₂ᵗ)) + ε)

`torch.optim.Adam` is the same; but the first torch optimiser that a process makes imports torch's compiler,
which takes a second of a fit of some ten.
"""

import functools
from collections.abc import Callable, Iterable

import torch
from torch import Tensor

from weingarten.fit.optimiser import Factor, Optimiser

FIRST, SECOND, EPSILON = 0.9, 0.999, 1e-8


class Adam(Optimiser):
    """See Optimiser. Elementwise, so that an ensemble's parts are moved as each would be alone."""

    def __init__(self, weights: Iterable[Tensor]) -> None:
        self.weights = list(weights)
        self.means = [torch.zeros_like(weight) for weight in self.weights]
        self.squares = [torch.zeros_like(weight) for weight in self.weights]
        self.steps = 0

    @property
    def size(self) -> int:
        """Two."""
        return 2

    def factors(self, rate: float) -> tuple[float, ...]:
        """−lr / (1 − β₁ᵗ) and √(1 − β₂ᵗ)."""
        self.steps += 1
        return -rate / (1.0 - FIRST**self.steps), (1.0 - SECOND**self.steps) ** 0.5

    def jobs(self, *factors: Factor) -> list[Callable[[], None]]:
        """See Optimiser: one."""
        return [functools.partial(self.descend, *factors)]

    @torch.no_grad()
    def descend(self, size: Factor, root: Factor) -> None:
        """Move all weights."""
        for weight, mean, square in zip(self.weights, self.means, self.squares, strict=True):
            if weight.grad is None:
                continue
            mean.lerp_(weight.grad, 1.0 - FIRST)
            square.mul_(SECOND).addcmul_(weight.grad, weight.grad, value=1.0 - SECOND)
            weight.add_((mean * size).div_((square.sqrt() / root).add_(EPSILON)))

    def state(self) -> dict[str, Tensor]:
        """Moments and the number of steps."""
        means = {f"mean.{i}": mean for i, mean in enumerate(self.means)}
        squares = {f"square.{i}": square for i, square in enumerate(self.squares)}
        return {**means, **squares, "steps": torch.tensor(self.steps)}

    def restore(self, state: dict[str, Tensor]) -> None:
        """The inverse of `state`."""
        for i, (mean, square) in enumerate(zip(self.means, self.squares, strict=True)):
            mean.copy_(state[f"mean.{i}"])
            square.copy_(state[f"square.{i}"])
        self.steps = int(state["steps"])

"""A jet in two large halves, for any thread, and what is small between them, for one thread at a time.

Threads that all ask for the interpreter wait for each other after every small operation. So whoever makes an
evaluation, reads its jet or hands in cotangents does so at the crew's desk; `forward` and `backward` run side
by side.
"""

from typing import Protocol, runtime_checkable

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.jet import Calculus, Jet

Bars = tuple[Tensor | None, ...]
"""Cotangents of a jet's tensors, in their order; None for zero."""


@runtime_checkable
class Evaluation(Protocol):
    """One jet, there and back."""

    def forward(self) -> None:
        """Work out the jet."""
        ...

    def jet(self) -> Jet:
        """After `forward`."""
        ...

    def pull(self, bars: Bars) -> None:
        """Say what the jet's cotangents are, before `backward`."""
        ...

    def backward(self) -> None:
        """Work out the gradients."""
        ...

    def gradient(self) -> Float[Tensor, " w"]:
        """After `backward`, once: of all weights, laid end to end in the order of the parameters."""
        ...


@runtime_checkable
class Staged(Protocol):
    """A calculus with evaluations of its own."""

    def begin(self, points: Float[Tensor, "n 3"], order: int, angles: Float[Tensor, " n"]) -> Evaluation: ...


class Taped:
    """The evaluation of any calculus, by autograd."""

    def __init__(
        self,
        calculus: Calculus,
        parameters: list[nn.Parameter],
        points: Float[Tensor, "n *m 3"],
        order: int,
        angles: Float[Tensor, "n *m"],
    ) -> None:
        self.calculus, self.parameters = calculus, parameters
        self.moved = [weight for weight in parameters if weight.requires_grad]
        self.arguments = points, order, angles

    def forward(self) -> None:
        """See Evaluation."""
        with torch.enable_grad():
            self.result = self.calculus(*self.arguments)

    def jet(self) -> Jet:
        """See Evaluation."""
        return self.result

    def pull(self, bars: Bars) -> None:
        """See Evaluation."""
        pairs = zip(self.result.tensors, bars, strict=True)
        self.pairs = [(tensor, bar) for tensor, bar in pairs if bar is not None]

    def backward(self) -> None:
        """See Evaluation."""
        tensors, bars = zip(*self.pairs, strict=True)
        sums = torch.autograd.grad(tensors, self.moved, bars, allow_unused=True, materialize_grads=True)
        self.sums = iter(sums)

    def gradient(self) -> Float[Tensor, " w"]:
        """See Evaluation."""
        found = [next(self.sums) if one.requires_grad else torch.zeros_like(one) for one in self.parameters]
        return torch.cat([one.reshape(-1) for one in found])

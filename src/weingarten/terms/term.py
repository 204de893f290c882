"""What a loss term is: per-point residuals, where they are taken, and the derivatives they need."""

from collections.abc import Callable
from dataclasses import dataclass

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import Jet
from weingarten.scan.sample import Sample


@dataclass(frozen=True)
class Term:
    """One row of a loss: mean over the points of `domains` of `residual(jet, sample)`.

    name: how figures and the loss curve call it. order: the jet's order that `residual` reads.
    """

    name: str
    residual: Callable[[Jet, Sample], Float[Tensor, " n"]]
    domains: tuple[str, ...]
    order: int

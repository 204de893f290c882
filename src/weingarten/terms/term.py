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
    share: of each domain's points, the first so many are taken: a mean over fewer, where the order is dear.
    """

    name: str
    residual: Callable[[Jet, Sample], Float[Tensor, " n"]]
    domains: tuple[str, ...]
    order: int
    share: float = 1.0

    def taken(self, count: int) -> int:
        """How many of a domain's points are taken, at least one of any."""
        return min(count, max(1, round(self.share * count)))

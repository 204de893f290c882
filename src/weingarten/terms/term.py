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

    A residual is pointwise: arrays are (n,), or (n, m) where m parts are fitted together, coordinates last.

    name: how figures and the loss curve call it. order: the jet's order that `residual` reads.
    shares: by domain, how much of its points is taken, the first ones: a mean over fewer, where the order is
    dear. All of them unless given.
    """

    name: str
    residual: Callable[[Jet, Sample], Float[Tensor, "n *m"]]
    domains: tuple[str, ...]
    order: int
    shares: tuple[float, ...] | None = None

    def taken(self, domain: str, count: int) -> int:
        """How many of a domain's points are taken, at least one of any."""
        share = 1.0 if self.shares is None else self.shares[self.domains.index(domain)]
        return min(count, max(1, round(share * count)))

    def total(self, count: int) -> int:
        """How many points it is a mean of, with `count` on each domain."""
        return sum(self.taken(domain, count) for domain in self.domains)

"""What a loss term is: per-point residuals, where they are taken, and the derivatives they need.

A term is of use alone too, in a training loop of any kind:

    loss = loss + 10 * OFF_DIAGONAL_WEINGARTEN(model, points).mean()
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.choice import exact
from weingarten.calculus.jet import TANGENT, Calculus, Jet
from weingarten.scan.sample import Sample


@dataclass(frozen=True)
class Term:
    """One row of a loss: mean over the points of `domains` of `residual(jet, sample)`.

    A residual is pointwise: arrays are (n,), or (n, m) where m parts are fitted together, coordinates last.

    name: how figures and the loss curve call it. order: the jet's order that `residual` reads.
    shares: by domain, how much of its points is taken, the first ones: a mean over fewer, where the order is
    dear. All of them unless given. moving: whether the residual asks for the sample's progress.
    """

    name: str
    residual: Callable[[Jet, Sample], Float[Tensor, "n *m"]]
    domains: tuple[str, ...]
    order: int
    shares: tuple[float, ...] | None = None
    moving: bool = False

    def __call__(
        self,
        field: nn.Module | Calculus,
        points: Float[Tensor, "n *m 3"],
        angles: Float[Tensor, "n *m"] | None = None,
        **known: Float[Tensor, "n ..."],
    ) -> Float[Tensor, "n *m"]:
        """The residuals of any field f: (n, 3) → (n,) at points of its unit, differentiable by its weights.

        field: a module, differentiated by autograd, or faster where it is one of this package; or a calculus
        of it, made once. angles: of the tangent frames, radians; drawn by torch's own generator unless given.
        known: what else the residual wants of a `Sample`, such as `distance`.
        """
        calculus = exact(field) if isinstance(field, nn.Module) else field
        if angles is None and self.order >= TANGENT:
            angles = 2.0 * torch.pi * torch.rand(points.shape[:-1], dtype=points.dtype, device=points.device)
        return self.residual(calculus(points, self.order, angles), replace(Sample(points), **known))

    def taken(self, domain: str, count: int) -> int:
        """How many of a domain's points are taken, at least one of any."""
        share = 1.0 if self.shares is None else self.shares[self.domains.index(domain)]
        return min(count, max(1, round(share * count)))

    def total(self, count: int) -> int:
        """How many points it is a mean of, with `count` on each domain."""
        return sum(self.taken(domain, count) for domain in self.domains)

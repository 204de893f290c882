"""A rule that balances many losses, applied to the weight of one of them."""

import math
from collections.abc import Iterable, Mapping
from typing import Any, Protocol, runtime_checkable

from weingarten.schedules.seen import Seen, sound

MOST = 1e6
"""No quotient is greater than this."""


@runtime_checkable
class Balancer(Protocol):
    """A rule for the weights of losses that are minimised together, as its source has it. Mutable.

    gradients_every: 0 where it never needs gradients; k where it wants them at every k-th step.
    """

    @property
    def gradients_every(self) -> int: ...

    def weights(self) -> dict[str, float]:
        """By name; only how they compare with each other matters."""
        ...

    def step(self, losses: Mapping[str, float], gradients: Mapping[str, float] | None) -> None:
        """Take in the losses, and the norms of their gradients where they were asked for."""
        ...

    def state(self) -> dict[str, Any]:
        """All that it remembers, as plain JSON values."""
        ...

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`, to the bit."""
        ...


class Balance:
    """A balancer's say about one term, relative to the fixed weights of the others. A Ratio.

    The losses that are balanced are ℓ_i = w_i L_i with the fixed weights w_i of the other terms, and
    ℓ = λ₀ L with the reference weight λ₀ of the scheduled one; gradients' norms likewise. The balancer's
    weights b would weigh them to Σ b_i ℓ_i. Since the others keep theirs and only proportions matter, all of
    b is divided by the others' mean:

        λ = λ₀ · b_term / mean of b_i over the other terms.

    It is λ₀ and not the λ of the step that makes ℓ: what a rule has already given would else be counted
    again as part of the loss. A loss that is NaN or beyond belief is not taken in: the last one stays. A term
    comes in at its first believable loss above zero under a positive weight: one that knows nothing, and is
    zero at all points, would else be given ever more weight, and all others less.
    """

    def __init__(self, term: str, reference: float, balancer: Balancer) -> None:
        self.term, self.reference, self.balancer = term, reference, balancer
        self.losses: dict[str, float] = {}
        self.gradients: dict[str, float] = {}

    @property
    def gradients_every(self) -> int:
        """The balancer's."""
        return self.balancer.gradients_every

    def ratio(self) -> float:
        """b_term / mean of the others' b; 1 where there is nothing to compare."""
        weights = self.balancer.weights()
        others = [weight for name, weight in weights.items() if name != self.term]
        if not others or self.term not in weights:
            return 1.0
        return quotient(weights[self.term], mean(others))

    def watch(self, seen: Seen) -> None:
        """Take in one step."""
        factors = {**seen.weights, self.term: self.reference}
        told = weighed(seen.losses, factors)
        self.losses |= {name: loss for name, loss in told.items() if loss > 0.0 or name in self.losses}
        if seen.gradients is None:
            self.balancer.step(self.losses, None)
            return
        told = weighed(seen.gradients, factors)
        self.gradients |= {name: norm for name, norm in told.items() if name in self.losses}
        self.balancer.step(self.losses, self.gradients)

    def state(self) -> dict[str, Any]:
        """All that it and its balancer remember, as plain JSON values."""
        return {
            "losses": dict(self.losses),
            "gradients": dict(self.gradients),
            "balancer": self.balancer.state(),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`, to the bit."""
        self.losses, self.gradients = dict(state["losses"]), dict(state["gradients"])
        self.balancer.restore(state["balancer"])


def weighed(values: Mapping[str, float], factors: Mapping[str, float]) -> dict[str, float]:
    """Each value times its factor, where that is positive and the product believable."""
    products = {name: factors.get(name, 0.0) * value for name, value in values.items()}
    return {
        name: product for name, product in products.items() if factors.get(name, 0.0) > 0 and sound(product)
    }


def mean(values: Iterable[float]) -> float:
    """The same in whatever order the values come."""
    known = list(values)
    return math.fsum(known) / len(known)


def quotient(value: float, other: float) -> float:
    """value / other within [0, MOST], for values that are not negative; 1 where both are zero."""
    if other > 0.0:
        return min(value / other, MOST)
    return MOST if value > 0.0 else 1.0


def quotients(losses: Mapping[str, float], others: Mapping[str, float]) -> dict[str, float]:
    """How each loss compares with an earlier one of its own; 1 where there was none."""
    return {name: quotient(loss, others.get(name, loss)) for name, loss in losses.items()}


def firsts(known: Mapping[str, float], losses: Mapping[str, float]) -> dict[str, float]:
    """The first loss of each that is not zero, with which later ones are compared."""
    return {name: loss for name, loss in losses.items() if loss > 0.0} | dict(known)


def softmax(exponents: Mapping[str, float]) -> dict[str, float]:
    """m exp(x_i) / Σ exp(x_j), whose mean is 1."""
    greatest = max(exponents.values(), default=0.0)
    powers = {name: math.exp(exponent - greatest) for name, exponent in exponents.items()}
    total = math.fsum(powers.values())
    return {name: len(powers) * power / total for name, power in powers.items()}

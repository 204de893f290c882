"""From a balancer's weights to one weight: against the definitions, written out."""

import math

import numpy as np
import pytest

from weingarten.schedules.adaptive import ADAPTIVE, Seen
from weingarten.schedules.balance import Balance, firsts, quotient, quotients, softmax
from weingarten.schedules.bounded import Bounded
from weingarten.schedules.gradient_norm import GradientNorm
from weingarten.schedules.random_lookback import RandomLookback
from weingarten.schedules.schedule import Schedule, constant
from weingarten.schedules.soft_adapt import SoftAdapt
from weingarten.schedules.task_priority import TaskPriority
from weingarten.schedules.uncertainty import Uncertainty

WEIGHTS = {"a": 7000.0, "b": 50.0, "c": 2.0}
LOSSES = {"a": 0.01, "b": 0.3, "c": 5.0}
NORMS = {"a": 0.2, "b": 4.0, "c": 30.0}


class Given:
    """A ratio, or a balancer, that says what it is told to and remembers what it was told."""

    gradients_every = 7

    def __init__(self, *ratios: float, **weights: float) -> None:
        self.ratios, self.own = list(ratios), weights
        self.told: list[tuple[dict, dict | None]] = []

    def ratio(self) -> float:
        return self.ratios[0]

    def watch(self, seen: Seen) -> None:
        self.ratios = self.ratios[1:] or self.ratios

    def weights(self) -> dict[str, float]:
        return dict(self.own)

    def step(self, losses, gradients) -> None:
        self.told.append((dict(losses), None if gradients is None else dict(gradients)))

    def state(self) -> dict:
        return {}

    def restore(self, state) -> None:
        pass


def seen(losses=LOSSES, weights=WEIGHTS, gradients=None, t=0.0) -> Seen:
    return Seen(t, losses, weights, gradients)


def test_the_ratio_is_to_the_mean_of_the_others():
    assert Balance("c", 3.0, Given(a=1.0, b=2.0, c=6.0)).ratio() == 4.0
    assert Balance("b", 3.0, Given(a=1.0, b=2.0, c=6.0)).ratio() == pytest.approx(2 / 3.5)


def test_nothing_to_compare_with():
    assert Balance("c", 3.0, Given(c=6.0)).ratio() == 1.0
    assert Balance("c", 3.0, Given(a=6.0)).ratio() == 1.0
    assert Balance("c", 3.0, Given()).ratio() == 1.0


def test_what_is_balanced_is_weighted_the_term_by_its_reference():
    given = Given()
    balance = Balance("c", 3.0, given)
    balance.watch(seen())
    balance.watch(seen(gradients=NORMS))
    losses = {"a": 7000.0 * 0.01, "b": 50.0 * 0.3, "c": 3.0 * 5.0}
    assert given.told == [(losses, None), (losses, {"a": 7000.0 * 0.2, "b": 50.0 * 4.0, "c": 3.0 * 30.0})]
    assert balance.gradients_every == 7


def test_what_cannot_be_believed_is_not_told():
    given = Given()
    balance = Balance("c", 3.0, given)
    balance.watch(seen({"a": 0.01, "b": math.nan, "c": math.inf}, {**WEIGHTS, "a": 0.0}))
    balance.watch(seen({"a": 0.01, "b": -1.0, "c": 1.0, "d": 1.0}))
    balance.watch(seen({"a": math.nan, "b": 0.0, "c": 1e99}, gradients={"a": 1.0}))
    balance.watch(seen({"a": 0.02, "b": 0.1, "c": 1e100}, gradients={"a": math.nan, "b": 2.0}))
    losses = [
        {},
        {"a": 70.0, "c": 3.0},
        {"a": 70.0, "c": 3e99},
        {"a": 140.0, "b": 5.0, "c": 3e99},
    ]
    for (told, _), expected in zip(given.told, losses, strict=True):
        assert told == pytest.approx(expected)
    assert [gradients for _, gradients in given.told] == [
        None,
        None,
        {"a": 7000.0},
        {"a": 7000.0, "b": 100.0},
    ]


def test_bounded_is_an_average_over_progress():
    ratios = [0.5, 0.1, 3.0, 0.2, 0.0]
    times = [0.0, 0.01, 0.04, 0.04, 0.5]
    bounded = Bounded(Given(1.0, *ratios), constant(4.0), smoothing=0.05)
    weight, before = 4.0, 0.0
    for ratio, t in zip(ratios, times, strict=True):
        bounded.watch(seen(t=t))
        share = 1.0 - math.exp(-(t - before) / 0.05)
        weight = (1.0 - share) * weight + share * 4.0 * min(ratio, 1.0)
        before = t
        assert bounded(t) == pytest.approx(weight, rel=1e-12)
    assert bounded.gradients_every == 7


def test_as_many_steps_as_you_like():
    few, many = (Bounded(Given(0.1), constant(4.0)) for _ in range(2))
    for bounded, steps in ((few, 50), (many, 5000)):
        for step in range(steps + 1):
            bounded.watch(seen(t=0.02 * step / steps))
    assert few(0.02) == pytest.approx(many(0.02), rel=1e-9) == pytest.approx(0.4 + 3.6 / math.e)


def test_the_envelope_limits_and_does_not_multiply():
    bounded = Bounded(Given(0.5), Schedule("linear", ((0.0, 4.0), (1.0, 0.0))))
    for t in np.linspace(0.0, 0.3, 100):
        bounded.watch(seen(t=float(t)))
    assert bounded(0.3) == pytest.approx(2.0, rel=1e-5)
    assert bounded(0.75) == pytest.approx(1.0)
    assert bounded(1.0) == 0.0


def test_what_a_ratio_above_one_asked_for_is_not_kept_for_later():
    bounded = Bounded(Given(50.0), constant(4.0))
    for t in np.linspace(0.0, 0.5, 100):
        bounded.watch(seen(t=float(t)))
    assert bounded.weight == pytest.approx(4.0)


def steady(balance: Balance, steps: int = 600) -> float:
    """The weight that the same losses and gradients lead to, in the end; relaxed from others at first."""
    balance.watch(seen({name: 3.0 * loss for name, loss in LOSSES.items()}, gradients=NORMS))
    for step in range(steps):
        balance.watch(seen(gradients=NORMS if step % 2 == 0 else None))
    return balance.reference * balance.ratio()


def test_kendall_levels_the_weighted_losses():
    harmonic = 2.0 / (1.0 / 70.0 + 1.0 / 15.0)
    for reference in (0.1, 2.0, 10.0):
        assert steady(Balance("c", reference, Uncertainty())) * LOSSES["c"] == pytest.approx(
            harmonic, rel=1e-6
        )


def test_gradnorm_levels_the_weighted_gradients():
    harmonic = 2.0 / (1.0 / 1400.0 + 1.0 / 200.0)
    for reference in (0.1, 2.0, 10.0):
        weight = steady(Balance("c", reference, GradientNorm(asymmetry=0.0)))
        assert weight * NORMS["c"] == pytest.approx(harmonic, rel=1e-6)


@pytest.mark.parametrize(
    "balancer", [Uncertainty, GradientNorm, TaskPriority, SoftAdapt, lambda: RandomLookback(3)]
)
def test_units_and_order_do_not_matter(balancer):
    generator = np.random.default_rng(0)
    plain, other = Balance("c", 2.0, balancer()), Balance("c", 2.0, balancer())
    for step in range(120):
        losses = {name: loss * float(np.exp(generator.normal() - step / 50)) for name, loss in LOSSES.items()}
        gradients = losses if step % 3 == 0 else None
        plain.watch(seen(losses, gradients=gradients))
        turned = {name: losses[name] / (100.0 if name == "a" else 1.0) for name in reversed(losses)}
        weights = {**WEIGHTS, "a": 100.0 * WEIGHTS["a"]}
        other.watch(seen(turned, weights, turned if gradients else None))
    assert other.ratio() == pytest.approx(plain.ratio(), rel=1e-9)
    assert plain.ratio() != 1.0


@pytest.mark.parametrize("name", ["dtp", "relobralo"])
def test_relative_rules_know_no_weights(name):
    one, two = (ADAPTIVE[name].begin("c", constant(reference), 1) for reference in (1.0, 4.0))
    for step in range(300):
        losses = {"a": math.exp(-step / 50), "b": math.exp(-step / 80), "c": math.exp(-step / 40)}
        one.watch(seen(losses, t=step / 300))
        two.watch(seen(losses, {"a": 3.0, "b": 1e5, "c": 1.0}, t=step / 300))
    assert two(1.0) == pytest.approx(4.0 * one(1.0), rel=1e-9)
    assert one(1.0) < 1.0


def test_softadapt_knows_no_common_factor():
    one, two = Balance("c", 2.0, SoftAdapt()), Balance("c", 200.0, SoftAdapt())
    for step in range(60):
        losses = {name: loss * math.exp(-step / 50 * loss) for name, loss in LOSSES.items()}
        one.watch(seen(losses))
        two.watch(seen(losses, {name: 100.0 * weight for name, weight in WEIGHTS.items()}))
    assert one.ratio() == pytest.approx(two.ratio(), rel=1e-9)


def test_quotients():
    assert quotient(1.0, 2.0) == 0.5
    assert quotient(0.0, 0.0) == 1.0
    assert quotient(1.0, 0.0) == quotient(1e100, 5e-324) == 1e6
    assert quotients({"a": 1.0, "b": 3.0}, {"a": 4.0}) == {"a": 0.25, "b": 1.0}
    assert firsts({"a": 2.0}, {"a": 1.0, "b": 0.0, "c": 3.0}) == {"a": 2.0, "c": 3.0}


def test_softmax():
    assert softmax({}) == {}
    assert softmax({"a": 1e6, "b": 1e6}) == {"a": 1.0, "b": 1.0}
    weights = softmax({"a": 0.3, "b": -1.0, "c": 2.0})
    powers = np.exp([0.3, -1.0, 2.0])
    assert list(weights.values()) == pytest.approx(list(3 * powers / powers.sum()), rel=1e-12)


@pytest.mark.parametrize(
    "build", [Uncertainty, GradientNorm, TaskPriority, SoftAdapt, lambda: RandomLookback(0)]
)
def test_a_term_that_knows_nothing_has_no_say(build):
    """Its loss and gradient are zero at every step, as those of signs are where nothing is certain."""
    without, with_it = (Balance("c", 3.0, build()) for _ in range(2))
    for step in range(40):
        losses = {name: loss * 0.97**step for name, loss in LOSSES.items()}
        without.watch(seen(losses, gradients=NORMS, t=step / 40))
        silent = {"silent": 0.0}
        told = seen(losses | silent, WEIGHTS | {"silent": 1000.0}, NORMS | silent, t=step / 40)
        with_it.watch(told)
    assert with_it.ratio() == pytest.approx(without.ratio(), rel=1e-12)

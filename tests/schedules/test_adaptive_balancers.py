"""The rules that descend (kendall, gradnorm) against their formulas in numpy, and where they come to rest."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.schedules.gradient_norm import GradientNorm, excess
from weingarten.schedules.uncertainty import Uncertainty

NAMES = ["a", "b", "c"]


def named(values) -> dict[str, float]:
    return {name: float(value) for name, value in zip(NAMES, values, strict=False)}


def listed(values: dict[str, float]) -> np.ndarray:
    return np.array([values[name] for name in NAMES if name in values])


def falling(steps: int, seed: int = 0) -> np.ndarray:
    """Losses by step and name."""
    generator = np.random.default_rng(seed)
    rates, starts = np.array([1.0, 2.0, 4.0]), np.array([300.0, 20.0, 1.0])
    times = np.linspace(0.0, 1.0, steps)[:, None]
    return starts * np.exp(-rates * times + 0.05 * generator.normal(size=(steps, 3)))


def test_kendall_is_descent_of_its_objective():
    rule, losses = Uncertainty(rate=0.1), falling(100)
    s = np.log(losses[0])
    for row in losses:
        rule.step(named(row), None)
        s = s - 0.1 * np.clip(0.5 * (1.0 - np.exp(-s) * row), -0.5, 0.5)
        assert listed(rule.weights()) == pytest.approx(np.exp(-s), rel=1e-12)


def test_kendall_s_derivative_is_that_of_the_objective():
    def objective(s: float) -> float:
        return 0.5 * (math.exp(-s) * 3.0 + s)

    rule = Uncertainty(rate=1.0)
    rule.s = {"a": 0.9}
    rule.step({"a": 3.0}, None)
    numeric = (objective(0.9 + 1e-6) - objective(0.9 - 1e-6)) / 2e-6
    assert 0.9 - rule.s["a"] == pytest.approx(numeric, rel=1e-6)


@settings(max_examples=25)
@given(losses=st.lists(st.floats(1e-6, 1e6), min_size=3, max_size=3), late=st.floats(1e-3, 1e3))
def test_kendall_rests_at_one_over_the_loss(losses, late):
    rule = Uncertainty()
    rule.step(named(losses), None)
    assert listed(rule.weights()) * losses == pytest.approx(np.ones(3), rel=1e-9)
    for _ in range(600):
        rule.step(named(np.array(losses) * late), None)
    assert listed(rule.weights()) * losses * late == pytest.approx(np.ones(3), rel=1e-6)


def test_kendall_survives_nothing_and_too_much():
    rule = Uncertainty(rate=1.0)
    for loss in (0.0, 1e100):
        for _ in range(400):
            rule.step({"a": loss}, None)
        assert 0.0 < rule.weights()["a"] < math.inf


def gradnorm_reference(own, norms, losses, first, a, rate):
    """One step by the formula: G, r, target; the logarithm's sign is the derivative's."""
    G = own * norms
    ratio = losses / first
    target = G.mean() * (ratio / ratio.mean()) ** a
    own = own * np.exp(-rate * np.clip(np.log(G / target), -1.0, 1.0))
    return len(own) * own / own.sum()


@pytest.mark.parametrize("a", [0.0, 0.12, 1.0, 1.5])
def test_gradnorm_by_its_formula(a):
    losses, generator = falling(60), np.random.default_rng(1)
    rule, own = GradientNorm(asymmetry=a, rate=0.2), np.ones(3)
    for index, row in enumerate(losses):
        norms = np.exp(2.0 * generator.normal(size=3))
        if index % 3:
            rule.step(named(row), None)
            continue
        rule.step(named(row), named(norms))
        own = gradnorm_reference(own, norms, row, losses[0], a, 0.2)
        assert listed(rule.weights()) == pytest.approx(own, rel=1e-9)
        assert sum(rule.weights().values()) == pytest.approx(3.0)


@pytest.mark.parametrize("seed", range(5))
def test_gradnorm_descends_its_source_s_sum(seed):
    generator = np.random.default_rng(seed)
    own, norms = np.exp(generator.normal(size=3)), np.exp(generator.normal(size=3))
    first, losses = np.exp(generator.normal(size=3)), np.exp(generator.normal(size=3))
    ratio = losses / first
    target = (own * norms).mean() * (ratio / ratio.mean()) ** 0.5

    def objective(weights: np.ndarray) -> float:
        return float(np.abs(weights * norms - target).sum())

    rule = GradientNorm(asymmetry=0.5, rate=1e-4)
    rule.first, rule.own = named(first), named(own)
    targets = rule.targets(named(losses), named(own * norms))
    assert listed(targets) == pytest.approx(target, rel=1e-12)
    moves = -np.array([excess(G, T) for G, T in zip(own * norms, listed(targets), strict=True)])
    assert objective(own * np.exp(1e-4 * moves)) < objective(own)
    for index, move in enumerate(moves):
        nudge = np.zeros(3)
        nudge[index] = 1e-7
        derivative = (objective(own + nudge) - objective(own - nudge)) / 2e-7
        assert np.sign(derivative) == -np.sign(move)


def test_gradnorm_leaves_equals_equal():
    rule = GradientNorm(asymmetry=1.5)
    for row in falling(50):
        share = row[0] / 300.0
        rule.step(named([7.0 * share, 0.2 * share, 40.0 * share]), named([2.0, 2.0, 2.0]))
        assert listed(rule.weights()) == pytest.approx(np.ones(3), rel=1e-12)


@pytest.mark.parametrize("a", [0.0, 0.12, 1.5])
def test_gradnorm_rests_where_gradients_go_as_the_rates(a):
    rule = GradientNorm(asymmetry=a)
    norms, left = np.array([5.0, 1.0, 0.01]), np.array([0.5, 0.1, 0.9])
    rule.step(named([1.0, 1.0, 1.0]), None)
    for _ in range(300):
        rule.step(named(left), named(norms))
    G = listed(rule.weights()) * norms
    assert G / left**a == pytest.approx(np.full(3, (G / left**a).mean()), rel=1e-6)


def test_gradnorm_gives_more_gradient_to_what_lags():
    rule = GradientNorm(asymmetry=1.0)
    rule.step(named([1.0, 1.0, 1.0]), named([1.0, 1.0, 1.0]))
    for _ in range(50):
        rule.step(named([0.1, 0.1, 0.9]), named([1.0, 1.0, 1.0]))
    a, b, c = listed(rule.weights())
    assert a == pytest.approx(b)
    assert c > 5.0 * a


def test_gradnorm_without_gradient_or_loss():
    assert excess(0.0, 0.0) == 0.0
    assert excess(0.0, 1.0) == -1.0 == -excess(1.0, 0.0)
    rule = GradientNorm()
    rule.step({}, {"a": 1.0})
    rule.step(named([0.0, 0.0, 0.0]), named([0.0, 0.0, 0.0]))
    assert listed(rule.weights()) == pytest.approx(np.ones(3))
    for _ in range(200):
        rule.step(named([1.0, 0.0, 1.0]), named([0.0, 1.0, 1e90]))
    assert np.isfinite(listed(rule.weights())).all()
    assert (listed(rule.weights()) > 0.0).all()

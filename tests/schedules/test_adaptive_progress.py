"""The rules that compare progress (dtp, softadapt, relobralo) against their formulas in numpy."""

import math

import numpy as np
import pytest

from weingarten.schedules.random_lookback import RandomLookback
from weingarten.schedules.soft_adapt import SoftAdapt
from weingarten.schedules.task_priority import TaskPriority

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


@pytest.mark.parametrize("focus", [0.5, 1.0, 2.0])
def test_dtp_by_its_formula(focus):
    rule, losses = TaskPriority(focus=focus, discount=0.1), falling(80)
    mean = None
    for row in losses:
        rule.step(named(row), None)
        now = np.clip(1.0 - row / losses[0], 0.05, 0.99)
        mean = now if mean is None else 0.1 * now + 0.9 * mean
        assert listed(rule.weights()) == pytest.approx(-((1.0 - mean) ** focus) * np.log(mean), rel=1e-12)


def test_dtp_gives_less_to_what_progresses_more():
    rule = TaskPriority()
    for row in falling(200):
        rule.step(named(row), None)
    a, b, c = listed(rule.weights())
    assert a > b > c > 0.0


def test_dtp_gives_most_to_what_has_not_moved():
    rule = TaskPriority()
    for _ in range(10):
        rule.step(named([2.0, 3.0]), None)
    assert listed(rule.weights()) == pytest.approx(np.full(2, -0.95 * math.log(0.05)))
    for _ in range(500):
        rule.step(named([0.0, 30.0]), None)
    assert listed(rule.weights()) == pytest.approx([-0.01 * math.log(0.99), -0.95 * math.log(0.05)])


def test_softadapt_by_its_formula():
    rule, losses = SoftAdapt(sharpness=2.0, block=10), falling(75)
    assert rule.weights() == {}
    for count, row in enumerate(losses, start=1):
        rule.step(named(row), None)
        if count < 20:
            continue
        means = losses[: count // 10 * 10].reshape(-1, 10, 3).mean(axis=1)
        slopes = means[-1] - means[-2]
        powers = np.exp(2.0 * slopes / np.abs(slopes).sum())
        assert listed(rule.weights()) == pytest.approx(3.0 * powers / powers.sum(), rel=1e-9)


def test_softadapt_leaves_equal_slopes_equal():
    rule = SoftAdapt(block=5)
    for step in range(40):
        rule.step(named(np.array([500.0, 50.0, 90.0]) - step), None)
    assert listed(rule.weights()) == pytest.approx(np.ones(3), rel=1e-12)


def test_softadapt_gives_most_to_what_rises():
    rule = SoftAdapt(block=5)
    for step in range(20):
        rule.step(named([10.0 - 0.1 * step, 10.0, 10.0 + 0.1 * step]), None)
    a, b, c = listed(rule.weights())
    assert a < b < c
    assert c / a == pytest.approx(math.e)


def test_softadapt_without_slope():
    rule = SoftAdapt(block=2)
    for _ in range(10):
        rule.step(named([1.0, 0.0]), None)
    assert rule.weights() == {"a": 1.0, "b": 1.0}
    rule.step(named([1.0, 0.0, 4.0]), None)
    rule.step(named([1.0, 0.0, 4.0]), None)
    assert rule.weights() == {"a": 1.0, "b": 1.0, "c": 1.0}


def balanced(now: np.ndarray, then: np.ndarray, temperature: float) -> np.ndarray:
    """bal(t, t')."""
    powers = np.exp(now / (temperature * then))
    return len(now) * powers / powers.sum()


@pytest.mark.parametrize("kept", [0.0, 0.7, 1.0])
def test_relobralo_by_its_formula(kept):
    rule, losses = RandomLookback(7, temperature=0.5, memory=0.9, kept=kept), falling(100)
    draws, own, looks = np.random.Generator(np.random.PCG64(7)), np.ones(3), 0
    for index, row in enumerate(losses):
        rule.step(named(row), None)
        rho = float(draws.random() < kept)
        looks += rho == 0.0
        history = rho * own + (1.0 - rho) * balanced(row, losses[0], 0.5)
        own = 0.9 * history + 0.1 * balanced(row, losses[max(0, index - 1)], 0.5)
        assert listed(rule.weights()) == pytest.approx(own, rel=1e-9)
        assert sum(rule.weights().values()) == pytest.approx(3.0)
    assert looks == {0.0: 100, 1.0: 0}.get(kept, looks)
    assert kept in (0.0, 1.0) or 10 < looks < 60


def test_relobralo_leaves_equal_progress_equal():
    rule = RandomLookback(0, kept=0.5)
    for step in range(100):
        rule.step(named(np.array([300.0, 20.0, 1.0]) * math.exp(-step / 30)), None)
        assert listed(rule.weights()) == pytest.approx(np.ones(3), rel=1e-9)


def test_relobralo_keeps_its_range_while_nothing_rises():
    rule, losses = RandomLookback(0, kept=0.9), [1.0, 1.0, 1.0]
    for _ in range(400):
        losses = [losses[0], losses[1] * 0.9, losses[2] * 0.99]
        rule.step(named(losses), None)
        a, b, c = listed(rule.weights())
        assert 1.0 <= max(a, b, c) / min(a, b, c) <= math.e + 1e-9
        assert a >= c >= b


def test_relobralo_draws_by_its_seed():
    def weights(seed: int) -> list[float]:
        rule = RandomLookback(seed, kept=0.8)
        return [float(rule.step(named(row), None) or rule.weights()["c"]) for row in falling(60)]

    assert weights(1) == weights(1)
    assert weights(1) != weights(2)

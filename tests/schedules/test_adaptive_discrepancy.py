"""The discrepancy controller in a loop with simple models of a fit."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from weingarten.errors import OptionError
from weingarten.schedules.adaptive import ADAPTIVE, Seen
from weingarten.schedules.discrepancy import FINEST, LEAST, Discrepancy
from weingarten.schedules.schedule import SCHEDULES, Schedule, constant

STRONG = 10.0
Model = Callable[[float, float], float]


def fitted(steepness: float, base: float = 3e-4) -> Model:
    """Residual that a fit tends to at progress t: a transient, and what a weight does to it, λ^p."""
    return lambda t, weight: base + 0.03 * math.exp(-t / 0.06) + 0.012 * (weight / STRONG) ** steepness


def closed(
    model: Model,
    noise: float,
    steps: int = 650,
    lag: float = 0.03,
    jitter: float = 0.05,
    envelope: Schedule | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Weights and residuals of a fit that follows the model with a lag, watched with noise."""
    adaptive = ADAPTIVE["discrepancy"].begin("curvature", envelope or constant(STRONG), 0, noise)
    generator = np.random.default_rng(0)
    residual, weights, residuals = 0.03, [], []
    for step in range(steps):
        t = step / steps
        weight = adaptive(t)
        residual += (1.0 - math.exp(-1.0 / (steps * lag))) * (model(t, weight) - residual)
        observed = residual * math.exp(jitter * generator.normal())
        losses = {"dirichlet": observed, "curvature": 5.0 if weight > 0.0 else math.nan}
        adaptive.watch(Seen(t, losses, {"dirichlet": 7000.0, "curvature": weight}))
        weights.append(weight)
        residuals.append(residual)
    return np.array(weights), np.array(residuals)


def reference(residuals: np.ndarray, times: np.ndarray, noise: float) -> list[float]:
    """The equations of the docstring, step by step."""
    quick = slow = math.log(residuals[0] / noise)
    exponent, ratios = 0.0, [1.0]
    for before, t, residual in zip(times[:-1], times[1:], residuals[1:], strict=True):
        e, dt = math.log(residual / noise), t - before
        quick += (1.0 - math.exp(-dt / 0.015)) * (e - quick)
        slow += (1.0 - math.exp(-dt / 0.045)) * (e - slow)
        slope = (quick - slow) / 0.03
        ahead = quick + min(0.1, 1.0 - t) * slope
        if t >= 0.1:
            exponent -= 10.0 * math.log(10.0) * dt * max(-1.0, min(ahead / 2.0, 1.0))
            exponent = max(math.log(1e-4), min(exponent, 0.0))
        ratios.append(math.exp(exponent))
    return ratios


def test_the_equations():
    times = np.linspace(0.0, 1.0, 301)[:-1]
    residuals = 0.01 * np.exp(np.sin(12.0 * times) - 2.0 * times)
    rule, ratios = Discrepancy(0.004), []
    for t, residual in zip(times, residuals, strict=True):
        rule.watch(Seen(float(t), {"dirichlet": float(residual)}, {"dirichlet": 7000.0}))
        ratios.append(rule.ratio())
    assert ratios == pytest.approx(reference(residuals, times, 0.004), rel=1e-9)
    assert min(ratios) < 0.2
    assert max(ratios[150:]) > 3.0 * min(ratios)


def test_averages_lag_by_their_memory():
    rule = Discrepancy(0.001)
    for step in range(5000):
        t = step / 10_000
        rule.watch(Seen(t, {"dirichlet": 0.05 * math.exp(-5.0 * t)}, {"dirichlet": 1.0}))
    assert rule.excess(0.5) == pytest.approx(math.log(50.0) - 2.5 + 5.0 * (0.015 - 0.1), abs=0.01)


@pytest.mark.parametrize("steepness", [0.5, 1.0, 2.5])
@pytest.mark.parametrize("noise", [0.002, 0.006])
@pytest.mark.parametrize("lag", [0.02, 0.06])
def test_it_settles_at_the_noise(steepness, noise, lag):
    weights, residuals = closed(fitted(steepness), noise, lag=lag)
    assert residuals[-1] == pytest.approx(noise, rel=0.12)
    assert np.log(residuals[-150:] / noise) == pytest.approx(np.zeros(150), abs=0.25)
    assert 0.0 < weights[-1] < STRONG


@pytest.mark.parametrize("steps", [200, 650, 5000])
def test_however_many_the_steps(steps):
    _, residuals = closed(fitted(1.0), 0.004, steps=steps)
    assert residuals[-1] == pytest.approx(0.004, rel=0.1)


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.01])
def test_the_strong_weight_is_held_at_the_start(noise):
    weights, residuals = closed(fitted(1.0), noise)
    early = int(0.1 * len(weights))
    assert residuals[:early].min() > 1.1 * noise
    assert (weights[: early + 1] == STRONG).all()


def test_a_fit_that_gets_there_by_itself_is_left_alone():
    weights, residuals = closed(
        lambda t, weight: 5e-4 + 0.03 * math.exp(-12.0 * t), 0.006, lag=0.005, jitter=0.0
    )
    assert (residuals[65:85] > 0.006).all()
    assert (weights == STRONG).all()


def test_the_same_residual_is_acted_upon_where_it_stalls():
    weights, _ = closed(lambda t, weight: 0.012, 0.008, jitter=0.0)
    assert weights[-1] < 0.1 * STRONG
    assert (np.diff(weights) <= 0.0).all()


def test_a_noisy_cloud_keeps_the_weight():
    weights, residuals = closed(fitted(1.0), 0.05)
    assert (residuals < 0.05).all()
    assert (weights == STRONG).all()


def test_a_cloud_without_noise_ends_with_next_to_none():
    weights, _ = closed(fitted(1.0), 0.0)
    assert weights[-1] == pytest.approx(LEAST * STRONG, rel=0.2)
    assert (np.diff(weights) <= 0.0).all()
    assert (closed(fitted(1.0), FINEST)[0] == weights).all()


def test_it_falls_no_faster_than_a_decade_in_a_tenth():
    weights, _ = closed(lambda t, weight: 1.0, 1e-3)
    later = weights[np.arange(len(weights)) >= 65]
    assert np.diff(np.log10(later)).min() * 65 >= -1.0 - 1e-9


def test_what_was_lowered_comes_back():
    weights, _ = closed(lambda t, weight: 0.02 if t < 0.4 else 0.001, 0.004, jitter=0.0)
    assert weights[260] < 0.1 * STRONG
    assert weights[-1] == pytest.approx(STRONG, rel=1e-3)


@pytest.mark.parametrize("absurd", [1e30, 1e-30, math.nan, math.inf, 0.0, -1.0])
def test_one_absurd_residual_does_little(absurd):
    rule, ratios = Discrepancy(0.004), []
    for step in range(650):
        residual = absurd if step == 300 else 0.004
        rule.watch(Seen(step / 650, {"dirichlet": residual}, {"dirichlet": 7000.0}))
        ratios.append(rule.ratio())
    assert min(ratios) > 0.7
    assert absurd in (1e30, 1e-30) or min(ratios) == 1.0


def test_it_needs_nothing_but_the_data_residual():
    without, within = Discrepancy(0.004), Discrepancy(0.004)
    for step in range(200):
        data = {"dirichlet": 0.01}
        without.watch(Seen(step / 200, data, {}))
        within.watch(
            Seen(step / 200, {**data, "curvature": math.nan}, {"dirichlet": 1.0}, {"curvature": 1.0})
        )
        assert without.ratio() == within.ratio()


def test_without_the_data_term_it_holds():
    rule = Discrepancy(0.004)
    for step in range(200):
        rule.watch(Seen(step / 200, {"eikonal": 1.0}, {"eikonal": 50.0}))
    assert rule.ratio() == 1.0


def test_the_envelope_is_honoured():
    weights, _ = closed(fitted(1.0), 0.004, envelope=SCHEDULES["quintic"])
    envelope = [SCHEDULES["quintic"](step / 650) for step in range(650)]
    assert (weights <= envelope).all()
    assert (weights[:66] == STRONG).all()


@pytest.mark.parametrize("noise", [-1e-3, math.nan, math.inf])
def test_a_noise_level_that_is_none(noise):
    with pytest.raises(OptionError, match="at least 0"):
        ADAPTIVE["discrepancy"].begin("curvature", constant(10.0), 0, noise)
    for name in set(ADAPTIVE) - {"discrepancy"}:
        ADAPTIVE[name].begin("curvature", constant(10.0), 0, noise)

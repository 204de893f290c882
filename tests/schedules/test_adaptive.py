"""What every adaptive weight keeps to, whatever it is told."""

import json
import math
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from weingarten.schedules.adaptive import ADAPTIVE, FULL, Adaptive, Seen
from weingarten.schedules.schedule import SCHEDULES, constant

WEIGHTS = {"dirichlet": 7000.0, "off_surface": 600.0, "eikonal": 50.0, "curvature": 10.0}
STARTS = {"dirichlet": 0.04, "off_surface": 0.06, "eikonal": 0.7, "curvature": 8.0}
HOSTILE = [math.nan, math.inf, -math.inf, -1.0, 0.0, 5e-324, 1e-30, 1e30, 1e100, 1e308]

names = pytest.mark.parametrize("name", sorted(ADAPTIVE))
values = st.one_of(st.sampled_from(HOSTILE), st.floats(0.0, 1e4))
rows = st.fixed_dictionaries(dict.fromkeys(WEIGHTS, values))
steps = st.lists(st.tuples(rows, st.one_of(st.none(), rows)), min_size=1, max_size=60)
envelopes = st.sampled_from([*SCHEDULES.values(), constant(3.0), constant(7000.0), constant(1e-12)])


def fit(seed: int, count: int = 200) -> Iterator[Seen]:
    """The steps of a made-up fit: losses fall at rates of their own, with noise; gradients at every fifth."""
    generator = np.random.default_rng(seed)
    rates = dict(zip(STARTS, generator.uniform(0.5, 6.0, len(STARTS)), strict=True))
    for step in range(count):
        t = step / count
        losses = {
            name: float(start * math.exp(-rates[name] * t + 0.1 * generator.normal()))
            for name, start in STARTS.items()
        }
        gradients = {name: 3.0 * loss for name, loss in losses.items()} if step % 5 == 0 else None
        yield Seen(t, losses, WEIGHTS, gradients)


def begun(name: str, seed: int = 0) -> Adaptive:
    """A fresh weight of the curvature term : its reference is 10."""
    return ADAPTIVE[name].begin("curvature", constant(10.0), seed, 0.002)


def followed(adaptive: Adaptive, fit: Iterator[Seen]) -> list[float]:
    """The weight before every step."""
    weights = []
    for seen in fit:
        weights.append(adaptive(seen.progress))
        adaptive.watch(seen)
    return weights


def test_the_names_are_the_keys():
    assert {name: rule.name for name, rule in ADAPTIVE.items()} == {name: name for name in ADAPTIVE}
    assert set(ADAPTIVE) == {"kendall", "gradnorm", "dtp", "softadapt", "relobralo", "discrepancy"}


@names
def test_what_a_rule_begins_is_adaptive(name):
    adaptive = begun(name)
    assert isinstance(adaptive, Adaptive)
    assert adaptive.gradients_every == (10 if name == "gradnorm" else 0)


@names
@given(steps=steps, envelope=envelopes)
def test_never_nan_negative_or_above_the_envelope(name, steps, envelope):
    adaptive = ADAPTIVE[name].begin("curvature", envelope, 0, 0.01)
    for index, (losses, gradients) in enumerate(steps):
        t = index / len(steps)
        assert 0.0 <= adaptive(t) <= envelope(t)
        adaptive.watch(Seen(t, losses, WEIGHTS, gradients))
    assert 0.0 <= adaptive(1.0) <= envelope(1.0)
    json.dumps(adaptive.state(), allow_nan=False)


@names
def test_it_recovers_from_hostile_losses(name):
    adaptive = begun(name)
    for index, value in enumerate(HOSTILE * 3):
        rowed = dict.fromkeys(WEIGHTS, value)
        adaptive.watch(Seen(0.1 * index / 30, rowed, WEIGHTS, rowed))
    followed(adaptive, fit(3, 2000))
    weight = adaptive(1.0)
    assert 0.0 < weight <= 10.0
    adaptive.watch(Seen(1.0, STARTS, WEIGHTS, STARTS))
    assert adaptive(1.0) == pytest.approx(weight, rel=0.5)


@names
def test_a_state_continues_to_the_bit(name):
    seen = list(fit(1))
    straight = begun(name)
    weights = followed(straight, iter(seen))
    for cut in (0, 1, 37, 120):
        first = begun(name)
        followed(first, iter(seen[:cut]))
        text = json.dumps(first.state(), allow_nan=False, sort_keys=True)
        followed(first, iter(seen[cut:]))
        second = begun(name, seed=5)
        second.restore(json.loads(text))
        assert followed(second, iter(seen[cut:])) == weights[cut:]
        assert second.state() == straight.state() == first.state()


@names
def test_a_state_is_no_window(name):
    adaptive = begun(name)
    followed(adaptive, fit(1, 60))
    state = adaptive.state()
    text = json.dumps(state)
    other = begun(name)
    other.restore(state)
    followed(adaptive, fit(2, 60))
    followed(other, fit(4, 60))
    assert json.dumps(state) == text


@names
def test_the_same_fit_gives_the_same_weights(name):
    assert followed(begun(name), fit(2)) == followed(begun(name), fit(2))


@names
def test_asking_changes_nothing(name):
    asked, unasked = begun(name), begun(name)
    for seen in fit(2, 50):
        for t in (0.0, 1.0, seen.progress):
            asked(t)
        asked.watch(seen)
        unasked.watch(seen)
    assert asked.state() == unasked.state()


@names
def test_it_moves(name):
    assert len(set(followed(begun(name), fit(1, 400)))) > 1


@names
def test_before_anything_was_seen_it_is_the_envelope(name):
    for envelope in (constant(3.0), SCHEDULES["quintic"], SCHEDULES["increasing"]):
        adaptive = ADAPTIVE[name].begin("curvature", envelope, 0, 0.01)
        assert [adaptive(t) for t in (0.0, 0.3, 1.0)] == [envelope(t) for t in (0.0, 0.3, 1.0)]
    assert ADAPTIVE[name].begin("curvature")(0.5) == FULL(0.5) == 10.0


@names
def test_an_envelope_that_ends_it_ends_it(name):
    adaptive = ADAPTIVE[name].begin("curvature", SCHEDULES["step-next"], 0, 0.01)
    for seen in fit(0):
        losses = dict(seen.losses)
        if adaptive(seen.progress) == 0.0:
            losses["curvature"] = math.nan
        adaptive.watch(Seen(seen.progress, losses, WEIGHTS, seen.gradients))
    assert adaptive(0.4) > 0.0
    assert adaptive(0.9) == 0.0


@names
def test_no_reference_no_weight(name):
    adaptive = ADAPTIVE[name].begin("curvature", SCHEDULES["none"], 0, 0.01)
    assert set(followed(adaptive, fit(0, 50))) == {0.0}


@names
@pytest.mark.parametrize("only", [{"curvature"}, {"dirichlet"}, set()])
def test_one_term_only_or_none(name, only):
    adaptive = ADAPTIVE[name].begin("curvature", constant(10.0), 0, 1.0)
    for seen in fit(0, 80):
        losses = {term: loss for term, loss in seen.losses.items() if term in only}
        weights = {term: weight for term, weight in WEIGHTS.items() if term in only}
        adaptive.watch(Seen(seen.progress, losses, weights, losses))
    assert adaptive(1.0) == 10.0


@names
def test_a_nan_keeps_what_was_known(name):
    nan, last = begun(name), begun(name)
    held: dict[str, float] = {}
    for index, seen in enumerate(fit(1)):
        gone = {term: math.nan for term in seen.losses if index % 3 and index > 10}
        held |= {term: loss for term, loss in seen.losses.items() if term not in gone}
        nan.watch(Seen(seen.progress, {**seen.losses, **gone}, WEIGHTS, seen.gradients))
        last.watch(Seen(seen.progress, dict(held), WEIGHTS, seen.gradients))
    assert nan(1.0) == last(1.0)


@names
def test_a_term_that_comes_late_is_taken_in(name):
    adaptive = ADAPTIVE[name].begin("curvature", SCHEDULES["increasing"], 0, 0.002)
    for seen in fit(0):
        losses = dict(seen.losses)
        if adaptive(seen.progress) == 0.0:
            losses["curvature"] = math.nan
        adaptive.watch(Seen(seen.progress, losses, WEIGHTS, seen.gradients))
    assert 0.0 < adaptive(1.0) <= 10.0

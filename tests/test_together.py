"""Many parts at once: each as it would be alone, and none stopped by another."""

import numpy as np
import pytest
import torch

import weingarten as wg
from weingarten import reconstruction, together
from weingarten.errors import CloudError, ExtractionError, FitError, OptionError
from weingarten.observer import Observer
from weingarten.samples.parts import sample_part

BRIEF = {"steps": 6, "points": 100, "resolution": 16, "sharp": False}


def ball(count: int, radius: float, centre: float) -> np.ndarray:
    """Points on a sphere."""
    directions = np.random.default_rng(0).normal(size=(count, 3))
    return radius * directions / np.linalg.norm(directions, axis=1, keepdims=True) + centre


class Watcher(Observer):
    """Remembers what it was told; asks to stop after so many records."""

    def __init__(self, most: int = 10**9) -> None:
        self.phases, self.records, self.notes, self.most = [], [], [], most

    def phase(self, name):
        self.phases.append(name)

    def step(self, record, steps, seconds):
        assert seconds > 0
        self.records.append((record.step, record.member))

    def note(self, text):
        self.notes.append(text)

    def interrupted(self):
        return len(self.records) >= self.most


@pytest.fixture(scope="module")
def clouds():
    return [ball(800, 2.0, 10.0), sample_part("flange", 1000, 0), ball(600, 0.01, 0.0)]


@pytest.mark.parametrize("method", ["odw", "odw-paper"])
def test_every_part_gets_what_it_would_get_alone(clouds, method):
    settings = wg.resolve(method=method, **BRIEF)
    for found, cloud in zip(wg.reconstruct_many(clouds, settings, device="cpu"), clouds, strict=True):
        expected = wg.reconstruct(cloud, settings, device="cpu")
        weights = zip(found.field.module.parameters(), expected.field.module.parameters(), strict=True)
        for one, other in weights:
            assert (one - other).abs().max() < 2e-3 * other.abs().max()
        assert found.field.frame == expected.field.frame
        assert found.settings == settings
        assert found.finished
        assert found.summary.loss == pytest.approx(expected.summary.loss, rel=1e-3)
        assert (found.summary.points, found.summary.steps) == (len(cloud), 6)
        assert list(found.summary.seconds) == list(expected.summary.seconds)
        assert set(expected.summary.notes) == set(found.summary.notes)
        size = expected.summary.diagonal
        np.testing.assert_allclose(found.mesh.bounds, expected.mesh.bounds, rtol=0, atol=0.05 * size)


def test_a_cloud_without_a_part_stops_no_other(clouds):
    flat = np.random.default_rng(0).random((200, 3)) * [1, 1, 0]
    settings = wg.resolve(**BRIEF)
    first, error, second = wg.reconstruct_many([clouds[0], flat, clouds[1]], settings)
    assert isinstance(error, CloudError)
    assert "one plane" in str(error)
    (alone,) = wg.reconstruct_many([clouds[1]], settings)
    assert second.summary.loss == pytest.approx(alone.summary.loss, rel=1e-3)
    assert first.summary.points == 800


def test_no_cloud_at_all_and_none_of_use():
    assert wg.reconstruct_many([]) == []
    errors = wg.reconstruct_many([np.zeros((5, 3)), np.zeros((200, 3))])
    assert [type(error) for error in errors] == [CloudError, CloudError]


def broken(monkeypatch, members):
    """From now on the first weights of these members are not numbers."""
    whole = together.joint

    def joint(settings, starts):
        loop = whole(settings, starts)
        with torch.no_grad():
            loop.field.weights[1][members] = float("nan")
        return loop

    monkeypatch.setattr(together, "joint", joint)


def test_a_fit_that_explodes_is_named_and_stops_no_other(clouds, monkeypatch):
    broken(monkeypatch, [1])
    watcher = Watcher()
    first, error, third = wg.reconstruct_many(clouds, wg.resolve(**BRIEF), observer=watcher)
    assert isinstance(error, FitError)
    assert "at step 0" in str(error)
    assert first.finished
    assert third.finished
    assert len(watcher.records) == 18


def test_when_every_fit_has_exploded_nothing_is_fitted_on(clouds, monkeypatch):
    broken(monkeypatch, [0, 1, 2])
    watcher = Watcher()
    outcomes = wg.reconstruct_many(clouds, wg.resolve(**BRIEF), observer=watcher)
    assert [type(outcome) for outcome in outcomes] == [FitError] * 3
    assert len(watcher.records) == 3


def test_a_field_without_a_surface_stops_no_other(clouds, monkeypatch):
    """As if the second part's field had no zero."""
    surface, calls = reconstruction.surface, []

    def sometimes(*arguments):
        calls.append(None)
        if len(calls) == 2:
            raise ExtractionError("The field has no surface.")
        return surface(*arguments)

    monkeypatch.setattr(reconstruction, "surface", sometimes)
    outcomes = wg.reconstruct_many(clouds, wg.resolve(**BRIEF))
    assert [isinstance(outcome, ExtractionError) for outcome in outcomes] == [False, True, False]


def test_an_observer_sees_every_part_and_can_stop(clouds):
    watcher = Watcher(most=6)
    outcomes = wg.reconstruct_many(clouds, wg.resolve(**BRIEF), observer=watcher)
    assert watcher.records == [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)]
    assert watcher.phases == ["preparing"] * 3 + ["fitting"] + ["extracting", "measuring"] * 3
    assert [(outcome.finished, outcome.summary.steps) for outcome in outcomes] == [(False, 2)] * 3


def test_crowded_parts_are_fitted_after_the_others_under_their_own_numbers(clouds):
    plate = np.random.default_rng(0).uniform(-1, 1, (800, 3))
    plate[:, 2] = np.where(np.arange(800) % 2, 0.05, -0.05)
    watcher = Watcher()
    settings = wg.resolve(**BRIEF)
    crowded, plain = wg.reconstruct_many([plate, clouds[0]], settings, observer=watcher)
    assert watcher.records == [(step, 1) for step in range(6)] + [(step, 0) for step in range(6)]
    assert crowded.summary.loss == pytest.approx(wg.reconstruct(plate, settings).summary.loss, rel=1e-3)
    assert plain.summary.loss == pytest.approx(wg.reconstruct(clouds[0], settings).summary.loss, rel=1e-3)


def test_mending_a_cloud_is_noted_once(clouds):
    watcher = Watcher()
    twice = np.concatenate([clouds[0], clouds[0][:5]])
    result, _ = wg.reconstruct_many([twice, clouds[1]], wg.resolve(**BRIEF), observer=watcher)
    assert "repeat another" in result.summary.notes[0]
    assert sum("repeat another" in note for note in watcher.notes) == 1


@pytest.mark.parametrize("schedule", ["kendall", "discrepancy"])
def test_weights_that_follow_one_fit_are_refused(schedule):
    with pytest.raises(OptionError, match="one by one"):
        wg.reconstruct_many([np.zeros((10, 3))], wg.resolve(schedule=schedule))

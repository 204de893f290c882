"""Presets resolve to plain values, and back from a file's."""

import pytest

from weingarten.calculus.jet import Progressive
from weingarten.errors import OptionError
from weingarten.methods import METHODS
from weingarten.schedules.schedule import DECREASING, INCREASING, SCHEDULES
from weingarten.settings import PRESETS, Settings, resolve
from weingarten.terms.free_space import FREE_SPACE


def test_the_paper_preset_is_the_papers():
    settings = resolve(preset="paper")
    assert (settings.steps, settings.points, settings.optimiser, settings.rate) == (
        10_000,
        20_000,
        "adam",
        5e-5,
    )
    assert (settings.shape, settings.knots, settings.decay, settings.clip) == (
        "quintic",
        DECREASING,
        "steady",
        10.0,
    )
    terms = settings.resolved_method().terms
    assert FREE_SPACE not in terms
    assert {term.name: weight(0.0) for term, weight in terms.items()} == {
        "dirichlet": 7000.0,
        "off_surface": 600.0,
        "eikonal": 50.0,
        "off_diagonal_weingarten": 10.0,
    }


@pytest.mark.parametrize("name", SCHEDULES)
def test_schedules_of_the_paper_preset_are_the_papers(name):
    method = resolve(preset="paper", schedule=name).resolved_method()
    assert [method.terms[method.scheduled](t) for t in (0.0, 0.3, 0.7)] == pytest.approx(
        [SCHEDULES[name](t) for t in (0.0, 0.3, 0.7)]
    )


def test_a_schedule_of_another_method_has_that_methods_greatest_weight():
    settings = resolve(schedule="increasing")
    assert [t for t, _ in settings.knots] == [t for t, _ in INCREASING]
    assert [w for _, w in settings.knots] == pytest.approx([0.3 * w for _, w in INCREASING])
    assert resolve(schedule="increasing", knots=((0.0, 2.0),)).knots == ((0.0, 2.0),)


@pytest.mark.parametrize("preset", PRESETS)
def test_settings_survive_a_file(preset):
    settings = resolve(preset=preset, seed=3, steps=7)
    assert Settings.from_dict(settings.as_dict()) == settings


@pytest.mark.parametrize(
    "wrong",
    [{"preset": "x"}, {"method": "x"}, {"schedule": "x"}, {"seed": -1}, {"steps": 0}, {"resolution": 5}],
)
def test_values_out_of_range(wrong):
    with pytest.raises(OptionError):
        resolve(**wrong)


def test_any_terms_weight_can_be_scheduled():
    settings = resolve(term="eikonal", schedule="linear")
    terms = {term.name: weight for term, weight in settings.resolved_method().terms.items()}
    assert [terms["eikonal"](t) for t in (0.0, 0.35, 0.5)] == pytest.approx([50.0, 25.0025, 0.005])
    assert terms["off_diagonal_weingarten"].greatest == 3.0
    with pytest.raises(OptionError, match="no term 'nope'; choose one of dirichlet"):
        resolve(term="nope")


@pytest.mark.parametrize("name", ["siren", "igr", "sal"])
def test_a_method_without_a_curvature_term_schedules_what_it_is_told_to(name):
    settings = resolve(method=name)
    assert (settings.term, settings.shape, settings.knots) == ("", "", ())
    assert Settings.from_dict(settings.as_dict()).resolved_method().terms == METHODS[name].terms
    for asked in ({"schedule": "none"}, {"knots": ((0.0, 1.0),)}):
        with pytest.raises(OptionError, match=f"{name} has no curvature term; say --term, one of "):
            resolve(method=name, **asked)
    first = next(iter(METHODS[name].terms))
    assert resolve(method=name, term=first.name, schedule="none").resolved_method().terms[first](0.0) == 0.0


@pytest.mark.parametrize("name", METHODS)
def test_a_weight_that_watches_the_data_needs_the_data_term(name):
    terms = {term.name for term in METHODS[name].terms}
    term = sorted(terms)[0]
    if "dirichlet" in terms:
        assert resolve(method=name, term=term, schedule="discrepancy").shape == "discrepancy"
    else:
        with pytest.raises(OptionError, match=f"watches the term 'dirichlet', which method {name} has not"):
            resolve(method=name, term=term, schedule="discrepancy")


def test_a_method_has_its_own_rate_with_each_optimiser():
    assert [resolve(preset, "igr").rate for preset in ("standard", "paper")] == [1.5e-2, 5e-3]
    assert [resolve(preset, "sal").rate for preset in ("standard", "paper")] == [1.5e-2, 5e-4]
    assert [resolve(preset, "digs").rate for preset in ("standard", "paper")] == [5e-4, 5e-5]
    assert resolve("paper", "igr", rate=1e-3).rate == 1e-3


def test_a_stencils_distance_can_be_scheduled():
    settings = resolve(method="odw-fd", stencil=((0.0, 0.1), (1.0, 0.01)))
    assert Settings.from_dict(settings.as_dict()) == settings
    assert resolve(method="odw-fd").stencil == ((0.0, 0.05),)
    field = settings.field()
    calculus = settings.resolved_method().calculus(field)
    assert isinstance(calculus, Progressive)
    assert calculus.at(0.5).step == pytest.approx(0.055)
    assert not isinstance(resolve(method="odw-fd").resolved_method().calculus(field), Progressive)
    with pytest.raises(OptionError, match="no stencil"):
        resolve(method="odw", stencil=((0.0, 0.1),))
    with pytest.raises(OptionError, match="above zero"):
        resolve(method="odw-fd", stencil=((0.0, 0.1), (1.0, 0.0))).resolved_method().calculus(field)


def test_weights_that_were_made_for_another_optimiser_are_a_note():
    (note,) = resolve(method="neurcadrecon").notes
    assert "--preset paper" in note
    assert not resolve(preset="paper", method="neurcadrecon").notes
    for preset in PRESETS:
        assert not resolve(preset=preset).notes
        assert not resolve(preset=preset, method="igr").notes

"""Contenders by name."""

import pytest

from weingarten.bench.lineup import lineup
from weingarten.errors import OptionError
from weingarten.settings import resolve


def test_every_method_under_every_schedule():
    made = lineup(["odw", "poisson", "gaussian"], ["own", "linear"], resolve(), weight=7.0)
    assert [one.name for one in made] == ["odw", "odw-linear-w7", "poisson", "gaussian", "gaussian-linear-w7"]


def test_a_method_brings_its_field_stencil_and_rate_with_it():
    (sal,) = lineup(["sal"], ["own"], resolve(steps=9))
    own = resolve(method="sal")
    assert own.rate != resolve().rate
    assert (sal.settings.method, sal.settings.rate, sal.settings.steps) == ("sal", own.rate, 9)
    (grid,) = lineup(["hash-grid"], ["own"], resolve())
    assert grid.settings == resolve(method="hash-grid")


def test_a_method_without_a_curvature_term_comes_once():
    made = lineup(["odw", "igr", "siren@9"], ["linear", "quintic"], resolve())
    assert [one.name for one in made] == ["odw-linear", "odw-quintic", "igr", "siren@9"]


def test_a_method_may_have_steps_of_its_own():
    made = lineup(["odw", "odw@400"], ["own"], resolve(steps=650))
    assert [(one.name, one.settings.steps) for one in made] == [("odw", 650), ("odw@400", 400)]


@pytest.mark.parametrize("text", ["odw@", "odw@x", "odw@-3"])
def test_steps_have_to_be_a_number(text):
    with pytest.raises(OptionError, match="odw@400"):
        lineup([text], ["own"], resolve())


def test_a_contender_takes_part_once():
    with pytest.raises(OptionError, match="twice"):
        lineup(["odw", "odw"], ["own"], resolve())

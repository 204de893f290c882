"""Contenders by name: methods, schedules of their weights, and the practitioner's alternative."""

from collections.abc import Sequence
from dataclasses import replace

from weingarten.bench.contender import POISSON, Contender, Neural, Poisson
from weingarten.errors import OptionError
from weingarten.methods import method_named
from weingarten.settings import Settings, resolve

OWN, NONE = "own", "none"
"""The schedule that a method comes with, and the one without any weight."""


def lineup(
    methods: Sequence[str],
    schedules: Sequence[str],
    budget: Settings,
    weight: float | None = None,
    oracle: bool = False,
) -> list[Contender]:
    """Every method under every schedule, as "METHOD-SCHEDULE" or, with its own schedule, "METHOD".

    methods: names of METHODS, with steps of their own where "@STEPS" follows, which stays in the contender's
    name; or "poisson". It and methods without a curvature term have nothing to schedule and come once, as
    "METHOD". schedules: names of SCHEDULES, or "own". budget: everything else. weight: the greatest one of a
    named schedule, by default the method's own greatest; it becomes part of the name, "odw-linear-w10".
    oracle: stop by the truth.

    Raises OptionError for a name that is unknown or comes twice.
    """
    made: list[Contender] = []
    for method in methods:
        if method == POISSON:
            made.append(Poisson())
        else:
            own = schedules if method_named(method.partition("@")[0]).scheduled else [OWN]
            made.extend(neural(method, schedule, budget, weight, oracle) for schedule in own)
    names = [one.name for one in made]
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise OptionError(f"{min(twice)} is to take part twice; name every method and schedule once.")
    return made


def neural(method: str, schedule: str, budget: Settings, weight: float | None, oracle: bool) -> Neural:
    """One method under one schedule."""
    name, at, steps = method.partition("@")
    if at and not steps.isdigit():
        raise OptionError(f"Steps of a method are a number after the @, as in odw@400; got {method!r}.")
    own = resolve(
        budget.preset,
        method=name,
        schedule=None if schedule == OWN else schedule,
        steps=int(steps) if at else budget.steps,
    )
    changed = ("method", "term", "shape", "knots", "stencil", "rate", "steps")
    settings = replace(budget, **{field: getattr(own, field) for field in changed})
    if schedule == OWN:
        return Neural(method, settings, oracle)
    label = f"{method}-{schedule}"
    if weight is None:
        return Neural(label, settings, oracle)
    scheduled = own.resolved_method().schedule.peaking(weight)
    return Neural(f"{label}-w{weight:g}", replace(settings, knots=scheduled.knots), oracle)

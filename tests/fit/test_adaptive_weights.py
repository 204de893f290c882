"""A loop under adaptive weights: told the truth, bounded, and resumed to the bit."""

import json
import math

import pytest
import torch

from weingarten.calculus.autodiff import Autodiff
from weingarten.methods import METHODS
from weingarten.scan.sample import NEAR, SURFACE
from weingarten.schedules.adaptive import ADAPTIVE
from weingarten.schedules.schedule import constant
from weingarten.schedules.weight import Adapted, weight_of
from weingarten.terms.dirichlet import DIRICHLET
from weingarten.terms.off_diagonal_weingarten import OFF_DIAGONAL_WEINGARTEN as ODW

SMALL = {"width": 16, "depth": 3, "points": 40, "steps": 30, "chunk": 40, "double": True}


def adapted(rule, weight=10.0):
    return METHODS["odw-paper"].with_schedule(Adapted(rule, constant(weight)))


@pytest.mark.parametrize("rule", ADAPTIVE)
def test_a_fit_under_a_rule_stays_within_its_bounds_and_resumes_to_the_bit(make_loop, rule):
    whole, first, second = (make_loop(adapted(rule), noise=1e-3, **SMALL) for _ in range(3))
    records = [whole.advance() for _ in range(30)]
    weights = [record.weights[ODW.name] for record in records]
    assert all(0.0 <= weight <= 10.0 for weight in weights)
    assert weights[0] == 10.0
    if rule in ("kendall", "gradnorm"):
        assert min(weights) < 9.9
    for _ in range(11):
        first.advance()
    second.field.load_state_dict(first.field.state_dict())
    for mine, its in zip(second.optimisers, first.optimisers, strict=True):
        mine.restore({name: value.clone() for name, value in its.state().items()})
    second.generator.set_state(first.generator.get_state())
    second.step = first.step
    second.adaptive[ODW.name].restore(json.loads(json.dumps(first.adaptive[ODW.name].state())))
    assert [second.advance() for _ in range(19)] == records[11:]


def test_the_gradients_that_a_rule_is_told_are_those_of_the_terms(make_loop):
    loop = make_loop(adapted("gradnorm"), **SMALL)
    state = loop.generator.get_state()
    found = loop.gradients()
    assert torch.equal(loop.generator.get_state(), state)
    samples = loop.draws(loop.count(0.0), loop.generator)
    calculus, weights = Autodiff(loop.field), list(loop.field.parameters())
    for term, domain in ((DIRICHLET, SURFACE), (ODW, NEAR)):
        jet = calculus(samples[domain].points, term.order, samples[domain].turns)
        loss = term.residual(jet, samples[domain]).mean()
        own = torch.autograd.grad(loss, weights, allow_unused=True, materialize_grads=True)
        norm = math.sqrt(sum(float(g.detach().square().sum()) for g in own))
        assert found[term.name] == pytest.approx(norm, rel=1e-9)


def test_what_is_asked_for_changes_no_draw(make_loop):
    """A step after gradients were taken is the step without."""
    plain, asked = (make_loop(METHODS["odw-paper"], **SMALL) for _ in range(2))
    asked.gradients()
    assert plain.advance() == asked.advance()


def test_weights_by_name():
    assert weight_of("kendall", ((0.0, 3.0),)) == Adapted("kendall", constant(3.0))
    assert weight_of("linear", ((0.0, 3.0),)) == constant(3.0)
    assert Adapted("dtp", constant(3.0)).peaking(6.0).greatest == 6.0

"""The loop: pieces add up, records tell the truth, weights of zero cost nothing, gradients are clipped."""

import math
from dataclasses import replace

import pytest
import torch

from weingarten.calculus.autodiff import Autodiff
from weingarten.crew import Crew
from weingarten.fit.estimate import estimate
from weingarten.fit.loop import Record, run
from weingarten.fit.optimisers import adam, cosine, muon, steady
from weingarten.methods import METHODS
from weingarten.scan.sample import NEAR, OFF_SURFACE, SURFACE
from weingarten.schedules.schedule import SCHEDULES, Schedule, constant
from weingarten.terms.dirichlet import DIRICHLET
from weingarten.terms.off_diagonal_weingarten import OFF_DIAGONAL_WEINGARTEN as ODW

SMALL = {"width": 16, "depth": 3, "points": 50, "steps": 10}
PAPER = METHODS["odw-paper"]


def gradients(loop):
    return [weight.grad.clone() for weight in loop.field.parameters()]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("chunk", [1, 7, 50])
def test_pieces_add_up_to_the_whole(make_loop, draws_for, method, chunk):
    results = []
    for size in (1000, chunk):
        draws = draws_for(METHODS[method])
        loop = make_loop(METHODS[method], draws=draws, double=True, chunk=size, **SMALL)
        (means,) = loop.accumulate(0.0)
        results.append((means, gradients(loop)))
    (whole, expected), (pieces, found) = results
    assert pieces == pytest.approx(whole, rel=1e-10)
    scale = max(gradient.abs().max() for gradient in expected)
    for one, other in zip(found, expected, strict=True):
        assert (one - other).abs().max() < 1e-10 * scale


@pytest.mark.parametrize("method", METHODS)
def test_every_method_moves_its_weights_at_the_first_step(make_loop, draws_for, method):
    """In float32, as a fit is: a gradient that overflows would be cut to nothing."""
    loop = make_loop(METHODS[method], draws=draws_for(METHODS[method]), **SMALL)
    before = [weight.detach().clone() for weight in loop.field.parameters()]
    assert math.isfinite(loop.advance().loss)
    after = list(loop.field.parameters())
    assert all(weight.isfinite().all() for weight in after)
    assert any(not torch.equal(one, other) for one, other in zip(before, after, strict=True))


def test_recorded_means_are_those_of_the_points(make_loop):
    loop = make_loop(PAPER, double=True, **SMALL)
    generator = torch.Generator()
    generator.set_state(loop.generator.get_state())
    samples = loop.draws(50, generator)
    values = {name: loop.field(sample.points).detach() for name, sample in samples.items()}
    at = torch.cat([samples[SURFACE].points, samples[NEAR].points]).requires_grad_(True)
    (slopes,) = torch.autograd.grad(loop.field(at).sum(), at)
    record = loop.advance()
    assert record.terms["dirichlet"] == pytest.approx(float(values[SURFACE].abs().mean()), rel=1e-10)
    off_surface = torch.exp(-100 * values[OFF_SURFACE].abs()).mean()
    assert record.terms["off_surface"] == pytest.approx(float(off_surface), rel=1e-10)
    eikonal = (slopes.square().sum(1) - 1).square().mean()
    assert record.terms["eikonal"] == pytest.approx(float(eikonal), rel=1e-10)
    assert record.loss == pytest.approx(sum(record.weights[n] * record.terms[n] for n in record.terms))


def test_a_record_says_where_it_was_taken(make_loop):
    loop = make_loop(PAPER, rate=cosine, **SMALL)
    records = [loop.advance() for _ in range(10)]
    assert [record.step for record in records] == list(range(10))
    assert [record.progress for record in records] == pytest.approx([i / 10 for i in range(10)])
    assert [record.rate for record in records] == pytest.approx([5e-5 * cosine(i, 10) for i in range(10)])
    expected = [PAPER.terms[ODW](i / 10) for i in range(10)]
    assert [record.weights["off_diagonal_weingarten"] for record in records] == expected


def test_a_term_of_weight_zero_is_not_evaluated_and_changes_nothing(make_loop):
    silent = PAPER.with_schedule(constant(0.0))
    without = replace(PAPER, terms={term: weight for term, weight in PAPER.terms.items() if term is not ODW})
    loops = [make_loop(method, **SMALL) for method in (silent, without)]
    orders = []
    calculus = loops[0].calculus
    loops[0].calculus = lambda points, order, angles: (orders.append(order), calculus(points, order, angles))[
        1
    ]
    records = [loop.advance() for loop in loops]
    assert sorted(orders) == [0, 1]
    assert math.isnan(records[0].terms["off_diagonal_weingarten"])
    assert records[0].loss == records[1].loss
    for one, other in zip(loops[0].field.parameters(), loops[1].field.parameters(), strict=True):
        assert torch.equal(one, other)


def test_a_term_of_weight_zero_is_still_told_where_it_costs_nothing(make_loop):
    method = replace(PAPER, terms={**PAPER.terms, DIRICHLET: constant(0.0)})
    record = make_loop(method, **SMALL).advance()
    assert record.terms["dirichlet"] > 0
    assert record.loss == pytest.approx(
        sum(record.weights[n] * record.terms[n] for n in record.terms if n != "dirichlet")
    )


def test_a_loss_without_any_weight_moves_nothing(make_loop):
    method = replace(PAPER, terms=dict.fromkeys(PAPER.terms, constant(0.0)))
    loop = make_loop(method, **SMALL)
    before = [weight.detach().clone() for weight in loop.field.parameters()]
    assert loop.advance().loss == 0.0
    assert all(torch.equal(a, b) for a, b in zip(before, loop.field.parameters(), strict=True))


@pytest.mark.parametrize("clip", [1e-3, 10.0])
def test_the_gradient_is_clipped(make_loop, clip):
    loop = make_loop(PAPER, clip=clip, **SMALL)
    loop.advance()
    norm = torch.cat([gradient.flatten() for gradient in gradients(loop)]).norm()
    assert float(norm) == pytest.approx(clip, rel=1e-4)


def test_a_small_gradient_is_left_alone(make_loop):
    loops = [make_loop(PAPER, clip=clip, **SMALL) for clip in (1e9, 1e12)]
    for loop in loops:
        loop.advance()
    assert all(torch.equal(a, b) for a, b in zip(*map(gradients, loops), strict=True))


@pytest.mark.parametrize("builder", [adam, muon])
def test_the_same_seed_gives_the_same_fit_to_the_bit(make_loop, builder):
    curves = []
    for noise in (0, 1):
        torch.manual_seed(noise)
        loop = make_loop(PAPER, **SMALL)
        loop.optimisers = builder(loop.field)
        curves.append([loop.advance().loss for _ in range(10)])
    assert curves[0] == curves[1]


def test_another_seed_gives_another_fit(make_loop):
    losses = [make_loop(PAPER, seed=seed, **SMALL).advance().loss for seed in (1, 2)]
    assert losses[0] != losses[1]


def test_a_loss_that_is_not_finite_is_seen_in_the_record(make_loop):
    loop = make_loop(PAPER, **SMALL)
    with torch.no_grad():
        loop.field.weights[1].fill_(float("nan"))
    assert math.isnan(loop.advance().loss)


def test_run_stops_when_told_and_hands_every_record_on(make_loop):
    loop, seen = make_loop(PAPER, **SMALL), []

    def each(record: Record, seconds: float) -> None:
        assert seconds > 0
        seen.append(record.step)

    assert run(loop, each, lambda: len(seen) == 4) is False
    assert seen == [0, 1, 2, 3]
    assert run(loop, each) is True
    assert seen == list(range(10))


def test_a_field_that_is_no_siren_is_fitted_by_autograd(make_loop, draws, generator):
    """Any torch module: here a small softplus network."""

    class Network(torch.nn.Module):
        def __init__(self):
            super().__init__()
            layers = [torch.nn.Linear(3, 16), torch.nn.Softplus(10.0), torch.nn.Linear(16, 1)]
            self.layers = torch.nn.Sequential(*layers)

        def forward(self, points):
            return self.layers(points)[:, 0]

    loop = make_loop(PAPER, **SMALL)
    loop.field = Network()
    loop.optimisers = muon(loop.field)
    loop.base_rate = 1e-3
    loop.__post_init__()
    losses = [loop.advance().loss for _ in range(10)]
    assert losses[-1] < losses[0]


def test_rates():
    assert [steady(step, 10) for step in (0, 9)] == [1.0, 1.0]
    rates = [cosine(step, 600) for step in range(600)]
    assert rates[0] == pytest.approx(1 / 50)
    assert max(rates) == rates[49] == rates[50] == 1.0
    assert rates[-1] == pytest.approx(0.02, abs=1e-4)
    assert rates[50:] == sorted(rates[50:], reverse=True)
    assert all(0 < cosine(step, 1) <= 1 for step in range(1))


def test_the_schedule_spans_the_fit(make_loop):
    method = PAPER.with_schedule(Schedule("step", ((0.0, 3.0), (0.5, 2.0), (0.9, 0.0))))
    loop = make_loop(method, **SMALL)
    seen = [loop.advance().weights["off_diagonal_weingarten"] for _ in range(10)]
    assert seen == [3.0] * 5 + [2.0] * 4 + [0.0]


def test_a_step_of_the_same_pieces_is_the_same_to_the_bit_with_any_number_of_threads(make_loop, signed_draws):
    moved = []
    for crew in (Crew(), Crew(1), Crew(3)):
        loop = make_loop(METHODS["odw"], draws=signed_draws, chunk=16, crew=crew, **SMALL)
        loop.optimisers = muon(loop.field)
        losses = []
        run(loop, lambda record, _, losses=losses: losses.append(record.loss))
        moved.append((losses, [weight.detach() for weight in loop.field.parameters()]))
    (losses, weights), *others = moved
    for other_losses, other_weights in others:
        assert other_losses == losses
        assert all(torch.equal(one, other) for one, other in zip(weights, other_weights, strict=True))


@pytest.mark.parametrize("share", [0.3, 1e-9])
def test_a_term_with_a_share_sees_the_first_points_alone(make_loop, share):
    partial = replace(ODW, shares=(share,))
    terms = {partial if term is ODW else term: weight for term, weight in PAPER.terms.items()}
    loop = make_loop(replace(PAPER, terms=terms, scheduled=partial), double=True, **SMALL)
    generator = torch.Generator()
    generator.set_state(loop.generator.get_state())
    samples = loop.draws(50, generator)
    count = max(1, round(50 * share))
    jet = Autodiff(loop.field)(samples[NEAR].points[:count], 2, samples[NEAR].angles[:count].double())
    expected = float(jet.shape_operator[1].detach().abs().mean())
    (means,) = loop.accumulate(0.0)
    assert means["off_diagonal_weingarten"] == pytest.approx(expected, rel=1e-6)
    whole = make_loop(PAPER, double=True, **SMALL)
    for name, mean in whole.accumulate(0.0)[0].items():
        if name != "off_diagonal_weingarten":
            assert means[name] == pytest.approx(mean, rel=1e-10)


def test_a_term_of_weight_zero_on_fewer_points_is_not_told(make_loop):
    partial = replace(ODW, shares=(0.3,))
    terms = {partial if term is ODW else term: weight for term, weight in PAPER.terms.items()}
    silent = replace(PAPER, terms=terms, scheduled=partial).with_schedule(constant(0.0))
    assert math.isnan(make_loop(silent, **SMALL).advance().terms["off_diagonal_weingarten"])


def test_points_grow_along_the_ramp_in_stages(make_loop):
    counts = []
    loop = make_loop(PAPER, ramp=(0.4, 1.6), **(SMALL | {"steps": 12}))
    draws = loop.draws
    loop.draws = lambda count, generator: (counts.append(count), draws(count, generator))[1]
    run(loop, lambda *_: None)
    assert counts == [20, 20, 32, 32, 44, 44, 56, 56, 68, 68, 80, 80]
    assert loop.count(1.0) == 80
    assert make_loop(PAPER, **SMALL).count(0.3) == 50


def test_a_weight_that_is_not_to_be_moved_stays(make_loop):
    loop = make_loop(PAPER, **SMALL)
    loop.optimisers = muon(loop.field)
    loop.field.weights[1].requires_grad_(False)
    before = [weight.detach().clone() for weight in loop.field.parameters()]
    loop.advance()
    for one, other in zip(before, loop.field.parameters(), strict=True):
        assert torch.equal(one, other) == (not other.requires_grad)


@pytest.mark.parametrize("method", ["odw-paper-fd", "divergence", "hash-grid"])
def test_a_weight_that_is_not_to_be_moved_stays_where_autograd_has_it(make_loop, draws_for, method):
    """Its part of the gradient is zero, and that of all others what it would be if it were moved as well."""
    frozen, free = (make_loop(METHODS[method], draws=draws_for(METHODS[method]), **SMALL) for _ in range(2))
    still = next(frozen.field.parameters())
    still.requires_grad_(False)
    before = still.detach().clone()
    for loop in (frozen, free):
        loop.accumulate(0.0)
    assert still.grad is None
    others = zip(list(frozen.field.parameters())[1:], list(free.field.parameters())[1:], strict=True)
    for one, other in others:
        torch.testing.assert_close(one.grad, other.grad)
    frozen.advance()
    assert torch.equal(still, before)


def test_what_is_to_come_is_told_of_a_fit_that_ends_with_nothing_to_do(make_loop, draws_for):
    method = METHODS["sal"].scheduling("sign_agnostic").with_schedule(SCHEDULES["linear"])
    found = estimate(make_loop(method, draws=draws_for(method), **SMALL), 32)
    assert 0.0 < found.extraction < found.total

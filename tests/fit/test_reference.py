"""The `paper` setting against a plain reference, over 40 to 80 steps that span the whole of each schedule.

Two fits of the same loss part from each other: with the paper's ω₀ and ODW weight a step multiplies a
difference of the weights by up to 10 (width 256), and Adam's first step takes the sign of every gradient,
rounding or not. The reference in float32 leaves the reference in float64 by 30 % within 20 to 60 steps. So
agreement is asked for where it means something:

- in float64, width 64, the free-running curves agree (measured: 6e-10 or better at the last step);
- in float32, full width, the curve of the engine is the reference's loss at the engine's own weights;
  its gradient likewise, and is no farther from the float64 gradient than the reference's.
"""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import torch

from weingarten.methods import METHODS
from weingarten.scan.sample import NEAR
from weingarten.schedules.schedule import SCHEDULES

spec = importlib.util.spec_from_file_location("reference", Path(__file__).parent / "reference.py")
assert spec is not None
assert spec.loader is not None
reference = importlib.util.module_from_spec(spec)
spec.loader.exec_module(reference)

STEPS = 80
LOOKED_AT = {"quintic": 1}
"""Every how many steps a float32 curve is compared: at all of the paper's schedule, every fifth of others."""
STENCIL = {"odw-paper": None, "odw-paper-fd": 0.05}


def in_turn(field):
    """Weights and biases as the reference has them: in turn, layer by layer."""
    return [x.detach() for pair in zip(field.weights, field.biases, strict=True) for x in pair]


def next_points(loop):
    """The points and near-surface angles that the loop's next step will see."""
    generator = torch.Generator()
    generator.set_state(loop.generator.get_state())
    samples = loop.draws(loop.points, generator)
    return {name: sample.points for name, sample in samples.items()}, samples[NEAR].angles


def scheduled(method, name):
    return METHODS[method].with_schedule(SCHEDULES[name])


@pytest.mark.parametrize("method", STENCIL)
@pytest.mark.parametrize("name", SCHEDULES)
def test_the_float64_loss_curve_is_the_references(make_loop, method, name):
    count, steps = 64, STEPS if name == "quintic" else 40
    loop = make_loop(scheduled(method, name), width=64, double=True, points=count, steps=steps)
    expected = reference.curve(
        in_turn(loop.field), loop.draws, torch.Generator().manual_seed(1), name, steps, count, STENCIL[method]
    )
    found = [loop.advance().loss for _ in range(steps)]
    np.testing.assert_allclose(found[:10], expected[:10], rtol=1e-10)
    np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.parametrize("name", SCHEDULES)
def test_the_float32_loss_curve_is_the_references(make_loop, name):
    """The reference in float64 at the loop's own weights: in float32 its own rounding reaches 2e-3.

    The machine code's stays below 2e-5 on one maker's processors and reaches 7e-5 on another's.
    """
    steps = STEPS if name == "quintic" else 60
    loop = make_loop(scheduled("odw-paper", name), points=48, steps=steps)
    for step in range(steps):
        if step % LOOKED_AT.get(name, 5):
            loop.advance()
            continue
        points, angles = next_points(loop)
        weights = [weight.detach().double() for weight in in_turn(loop.field)]
        at = {domain: x.double() for domain, x in points.items()}
        expected = reference.loss(weights, at, angles.double(), reference.schedule(name, step / steps))
        assert loop.advance().loss == pytest.approx(float(expected.detach()), rel=2e-4)


@pytest.mark.parametrize("method", STENCIL)
@pytest.mark.parametrize("steps", [0, 60])
def test_the_float32_gradient_is_as_near_to_the_exact_one_as_the_references(make_loop, method, steps):
    loop = make_loop(scheduled(method, "constant"))
    for _ in range(steps):
        loop.advance()
    points, angles = next_points(loop)

    def gradient(dtype):
        weights = [weight.to(dtype).requires_grad_(True) for weight in in_turn(loop.field)]
        at = {name: x.to(dtype) for name, x in points.items()}
        total = reference.loss(weights, at, angles.to(dtype), 10.0, STENCIL[method])
        return torch.cat([x.flatten().double() for x in torch.autograd.grad(total, weights)])

    exact, plain = gradient(torch.float64), gradient(torch.float32)
    loop.field.zero_grad()
    loop.accumulate(0.0)
    pairs = zip(loop.field.weights, loop.field.biases, strict=True)
    found = torch.cat([x.grad.flatten().double() for pair in pairs for x in pair])
    assert (found - exact).norm() <= 2 * (plain - exact).norm() + 1e-6 * exact.norm()
    assert (found - exact).norm() <= 2e-3 * exact.norm()


def test_the_float32_curve_follows_the_reference_until_rounding_has_grown(make_loop):
    loop = make_loop(scheduled("odw-paper", "quintic"), width=32, points=64, steps=STEPS)
    expected = reference.curve(
        in_turn(loop.field), loop.draws, torch.Generator().manual_seed(1), "quintic", STEPS, 64
    )
    found = [loop.advance().loss for _ in range(20)]
    np.testing.assert_allclose(found, expected[:20], rtol=3e-4)

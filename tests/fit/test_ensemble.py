"""Parts fitted together are fitted as each would be alone."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree

from weingarten.crew import Crew
from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren
from weingarten.fit.loop import Loop
from weingarten.fit.optimisers import adam, cosine, muon
from weingarten.frame import Frame
from weingarten.methods import METHODS
from weingarten.samples.parts import sample_part
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.generators import Generators
from weingarten.scan.interleaved import Interleaved
from weingarten.scan.oriented_draws import OrientedDraws
from weingarten.schedules.schedule import constant

STEPS, FEW = 30, 8
SETTING = {"rate": cosine, "base_rate": 5e-4, "steps": STEPS, "points": 40, "clip": 10.0, "ramp": (0.5, 1.5)}


class InDouble:
    """Draws in float64."""

    def __init__(self, inner):
        self.inner = inner

    def __call__(self, count, generator):
        samples = self.inner(count, generator)
        return {name: sample.each(torch.Tensor.double) for name, sample in samples.items()}


@pytest.fixture(scope="module")
def parts():
    """Draws of three bundled parts, of unlike numbers of points."""
    found = []
    for i, name in enumerate(("flange", "bracket", "block")):
        points = sample_part(name, 600 + 100 * i, i)
        points = Frame.of(points).to_unit(points)
        tree = KDTree(points)
        space = FreeSpace.of(points, tree, 1.1)
        found.append(OrientedDraws(points, tree, space, torch.Generator().manual_seed(i)))
    return found


def field(seed, dtype):
    return Siren(24, 3, generator=torch.Generator().manual_seed(seed)).to(dtype)


def generator(seed):
    return torch.Generator().manual_seed(100 + seed)


def alone(parts, method, optimiser, dtype, **options):
    """A loop for each part."""
    loops = []
    for i, draws in enumerate(parts):
        own, seen = field(i, dtype), InDouble(draws) if dtype is torch.float64 else draws
        settings = SETTING | {"optimisers": optimiser(own)} | options
        loops.append(Loop(own, method, seen, generator(i), **settings))
    return loops


def together(parts, method, optimiser, dtype, crew=None, **options):
    """One loop for all of them."""
    seeds, crew = range(len(parts)), crew or Crew()
    ensemble = Ensemble.of([field(i, dtype) for i in seeds])
    draws = Interleaved([InDouble(draws) if dtype is torch.float64 else draws for draws in parts])
    settings = SETTING | {"optimisers": optimiser(ensemble), "crew": crew} | options
    return Loop(ensemble, method, draws, Generators([generator(i) for i in seeds]), **settings)


def assert_equal_fits(joint, loops, steps, accuracy):
    for _ in range(steps):
        records = joint.stride()
        assert [record.member for record in records] == [0, 1, 2]
        for record, loop in zip(records, loops, strict=True):
            own = loop.advance()
            assert record.step == own.step
            assert record.weights == own.weights
            assert record.terms == pytest.approx(own.terms, rel=accuracy, nan_ok=True)
    for i, loop in enumerate(loops):
        for one, other in zip(joint.field.member(i).parameters(), loop.field.parameters(), strict=True):
            assert (one - other).abs().max() <= accuracy * other.abs().max()


@pytest.mark.parametrize("method", [name for name, row in METHODS.items() if row.field is Siren])
@pytest.mark.parametrize("optimiser", [adam, muon])
def test_a_fit_together_is_the_fits_alone(parts, method, optimiser):
    row = METHODS[method]
    standing = replace(row, terms={term: constant(weight.greatest) for term, weight in row.terms.items()})
    setting = (parts, standing, optimiser, torch.float64)
    assert_equal_fits(together(*setting), alone(*setting), FEW, 1e-9)


@pytest.mark.parametrize("chunk", [17, 50])
@pytest.mark.parametrize("crew", [Crew(), Crew(2)])
def test_pieces_of_the_points_hold_every_part(parts, chunk, crew):
    """As the method's own schedule has it: the curvature's weight ends after a third of the steps."""
    setting = (parts, METHODS["odw"], muon, torch.float64)
    assert_equal_fits(together(*setting, crew=crew, chunk=chunk), alone(*setting), STEPS, 1e-9)


@pytest.mark.parametrize("optimiser", [adam, muon])
def test_in_float32_they_part_by_rounding_alone(parts, optimiser):
    """Five steps: later, rounding has grown as between any two float32 fits (see test_reference)."""
    setting = (parts, METHODS["odw"], optimiser, torch.float32)
    assert_equal_fits(together(*setting), alone(*setting), 5, 2e-3)


@pytest.mark.parametrize("optimiser", [adam, muon])
def test_a_part_that_explodes_alters_no_other_and_is_named(parts, optimiser):
    setting = (parts, METHODS["odw"], optimiser, torch.float32)
    sound, broken = together(*setting), together(*setting)
    with torch.no_grad():
        broken.field.weights[1][1].fill_(float("nan"))
    for _ in range(5):
        expected, records = sound.stride(), broken.stride()
        assert [np.isfinite(record.loss) for record in records] == [True, False, True]
        assert [records[i].terms for i in (0, 2)] == [expected[i].terms for i in (0, 2)]
    for one, other in zip(broken.field.parameters(), sound.field.parameters(), strict=True):
        assert torch.equal(one[[0, 2]], other[[0, 2]])


def test_each_part_is_clipped_by_its_own_norm(parts):
    joint = together(parts, METHODS["odw"], adam, torch.float64, clip=1e-3)
    joint.stride()
    for i in range(3):
        norm = torch.cat([weight.grad[i].flatten() for weight in joint.field.parameters()]).norm()
        assert float(norm) == pytest.approx(1e-3, rel=1e-4)


def test_memory_does_not_grow_with_the_parts(parts):
    """A piece holds so many points of all the parts, not of each."""
    joint, seen = together(parts, METHODS["odw"], adam, torch.float32, chunk=9), []
    calculus = joint.calculus
    joint.calculus = lambda points, *rest: (seen.append(points.shape), calculus(points, *rest))[1]
    joint.stride()
    assert {shape[1:] for shape in seen} == {(3, 3)}
    assert max(shape[0] for shape in seen) == 3

"""A small cloud and its draws, shared by the tests of the fit."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree

from weingarten.fit.loop import Loop
from weingarten.fit.optimisers import adam, steady
from weingarten.frame import Frame
from weingarten.samples.parts import sample_part
from weingarten.scan.draws import CloudDraws, MeasuredDraws, SignedDraws
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.knowledge import signs_and_normals, unsigned_distances
from weingarten.scan.oriented_draws import OrientedDraws


class InDouble:
    """Draws in float64."""

    def __init__(self, inner):
        self.inner = inner

    def __call__(self, count, generator):
        samples = self.inner(count, generator)
        return {name: self.double(sample) for name, sample in samples.items()}

    @staticmethod
    def double(sample):
        known = {name: getattr(sample, name) for name in ("distance", "unsigned", "normals")}
        known = {name: value if value is None else value.double() for name, value in known.items()}
        return replace(sample, points=sample.points.double(), **known)


@pytest.fixture(scope="session")
def cloud() -> np.ndarray:
    """The bundled flange, 2,000 points in the unit frame."""
    points = sample_part("flange", 2000, 0)
    return Frame.of(points).to_unit(points)


@pytest.fixture(scope="session")
def draws(cloud):
    return CloudDraws(cloud, KDTree(cloud))


@pytest.fixture(scope="session")
def signed_draws(cloud):
    tree = KDTree(cloud)
    return SignedDraws(cloud, tree, FreeSpace.of(cloud, tree, 1.1), torch.Generator().manual_seed(0))


@pytest.fixture(scope="session")
def draws_for(cloud, signed_draws):
    """From a method to draws that know what it asks for; signs, too, of methods that do not ask."""
    tree = KDTree(cloud)
    measured = MeasuredDraws(cloud, tree, torch.Generator().manual_seed(0))
    space = FreeSpace.of(cloud, tree, 1.1)
    oriented = OrientedDraws(cloud, tree, space, torch.Generator().manual_seed(0))
    known = {unsigned_distances: measured, signs_and_normals: oriented}
    return lambda method: known.get(method.knowledge, signed_draws)


@pytest.fixture
def make_loop(draws):
    """Loops of the `paper` setting with another seed, size or anything else."""

    def make(method, *, draws=draws, seed=1, width=256, depth=5, double=False, **options):
        field = method.field(width, depth, 30.0, torch.Generator().manual_seed(0))
        field = field.double() if double else field
        settings = {
            "draws": InDouble(draws) if double else draws,
            "generator": torch.Generator().manual_seed(seed),
            "optimisers": adam(field),
            "rate": steady,
            "base_rate": 5e-5,
            "steps": 200,
            "points": 128,
            "clip": 10.0,
        }
        return Loop(field, method, **(settings | options))

    return make

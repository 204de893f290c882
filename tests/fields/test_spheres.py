"""Every initialisation that promises a sphere's distance, measured at step 0; an ordinary SIREN fails."""

import pytest
import torch

from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.jet import GRADIENT
from weingarten.fields.choice import hash_grid, quadratic_siren, softplus_net, sphere_siren
from weingarten.fields.hash_grid import HashGrid
from weingarten.fields.initialise import geometric, multi_frequency
from weingarten.fields.siren import Siren
from weingarten.fields.softplus import SoftplusNet
from weingarten.fields.sphered import Sphered


def seeded(seed):
    return torch.Generator().manual_seed(seed)


def sine(initialise, width):
    def make(seed, radius):
        siren = Siren(width, 5, 30.0, seeded(seed))
        initialise(siren, seeded(seed))
        return Sphered(siren, radius)

    return make


FIELDS = {
    "geometric": (sine(geometric, 256), 0.012),
    "geometric, narrow": (sine(geometric, 160), 0.02),
    "multi-frequency": (sine(multi_frequency, 256), 0.02),
    "multi-frequency, narrow": (sine(multi_frequency, 160), 0.05),
    "softplus": (lambda seed, radius: SoftplusNet(512, 8, radius, seeded(seed)), 0.2),
    "hash grid": (lambda seed, radius: HashGrid(radius=radius, generator=seeded(seed)), 0.012),
}
"""Made from a seed and a radius, with the greatest mean |f − (‖x‖ − r)| over the box. The softplus network's
layers are random, as its authors have them, and keep lengths on average alone."""


def box():
    return 2.2 * torch.rand(4000, 3, generator=seeded(9)) - 1.1


def error(field, radius):
    with torch.no_grad():
        return float((field(box()) - (box().norm(dim=1) - radius)).abs().mean())


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("radius", [1.0, 0.5])
@pytest.mark.parametrize("seed", [0, 1])
def test_it_begins_as_a_spheres_distance(name, radius, seed):
    make, most = FIELDS[name]
    assert error(make(seed, radius), radius) < most


@pytest.mark.parametrize("seed", [0, 1])
def test_an_ordinary_siren_does_not(seed):
    assert error(Siren(256, 5, 30.0, seeded(seed)), 0.5) > 0.2


def test_without_its_root_it_is_no_distance():
    """What released re-implementations have: the square, shifted."""
    siren = Siren(256, 5, 30.0, seeded(0))
    geometric(siren, seeded(0))
    points = box()
    with torch.no_grad():
        square = siren(points)
        scaled = square * (points.square().sum(1) @ square) / (square @ square)
    assert (scaled - points.square().sum(1)).abs().mean() < 0.1
    assert (scaled - points.norm(dim=1)).abs().mean() > 0.1


@pytest.mark.parametrize("make", [sphere_siren, quadratic_siren, softplus_net, hash_grid])
def test_the_methods_fields_point_outwards(make):
    field = make(160, 5, 30.0, seeded(3))
    points = box()
    jet = Autodiff(field)(points, GRADIENT)
    away = points.norm(dim=1) > 0.2
    outward = torch.nn.functional.cosine_similarity(jet.slope, points, dim=1)[away]
    assert outward.mean() > 0.9
    assert field(1.8 * torch.eye(3)).min() > 0.0 > field(torch.zeros(1, 3)).item()


@pytest.mark.parametrize("make", [sphere_siren, quadratic_siren])
def test_digs_and_steik_begin_as_the_authors_have_it(make):
    points = box()
    with torch.no_grad():
        found = make(256, 5, 30.0, seeded(3))(points)
    assert (found - 0.1 * (1.11 * points.norm(dim=1) - 1.6)).abs().mean() < 0.005


@pytest.mark.parametrize("make", [sphere_siren, quadratic_siren, softplus_net, hash_grid])
def test_the_generator_alone_decides(make):
    fields = []
    for noise in (1, 2):
        torch.manual_seed(noise)
        fields.append(make(16, 3, 30.0, seeded(5)))
    same = zip(fields[0].parameters(), fields[1].parameters(), strict=True)
    assert all(torch.equal(a, b) for a, b in same)
    other = make(16, 3, 30.0, seeded(6))
    assert not all(torch.equal(a, b) for a, b in zip(fields[0].parameters(), other.parameters(), strict=True))


@pytest.mark.parametrize(("initialise", "depth"), [(geometric, 1), (multi_frequency, 2)])
def test_too_few_layers_are_refused(initialise, depth):
    with pytest.raises(ValueError, match="sine layers"):
        initialise(Siren(8, depth))

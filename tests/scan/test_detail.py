"""How finely a part is detailed: edges are counted by length per area, whatever the density of the cloud."""

import math

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree
from trimesh.creation import box
from trimesh.sample import sample_surface

from weingarten.fields.siren import Siren
from weingarten.frame import Frame
from weingarten.samples.parts import sample_part
from weingarten.scan.detail import FINEST, LEAST_KNOWN, PLAIN, detail
from weingarten.scan.draws import REACH
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.orientation import TRUSTED, Orientation
from weingarten.scan.oriented_draws import OrientedDraws
from weingarten.scan.sheets import Sheets
from weingarten.settings import resolve
from weingarten.start import Start


def draws_of(points):
    unit = Frame.of(points).to_unit(points)
    tree = KDTree(unit)
    return OrientedDraws(unit, tree, FreeSpace.of(unit, tree, REACH), torch.Generator().manual_seed(0))


def comb(count, fins, seed=0):
    """A block of side 2 whose top is cut by square grooves: so many fins, as wide as the gaps beside them."""
    pitch = 2.0 / (2 * fins - 1)
    blocks = [box((2.0, 2.0, 1.0)).apply_translation((0.0, 0.0, -0.5))]
    for i in range(fins):
        middle = -1.0 + (2 * i + 0.5) * pitch
        blocks.append(box((pitch, 2.0, pitch)).apply_translation((middle, 0.0, 0.5 * pitch)))
    random = np.random.default_rng(seed)
    sides = [sample_surface(block, round(2 * count * block.area / 24), seed=random)[0] for block in blocks]
    points = np.concatenate(sides)
    shared = np.abs(points[:, 2]) < 1e-9
    fin = np.floor((points[:, 0] + 1.0) / pitch).astype(int) % 2 == 0
    return points[~(shared & fin)]


def known(doubtful, radius, count=1000):
    """With such a share of neighbourhoods that are not flat."""
    normals = np.tile([1.0, 0.0, 0.0], (count, 1))
    near = np.zeros((count, 1), dtype=np.int64)
    return Orientation(normals, radius, doubtful, Sheets.of(np.zeros((count, 3)), normals, near))


def test_it_is_the_root_of_the_length_of_edges_per_area():
    found = detail(known(0.2, 0.02))
    assert found == pytest.approx(math.sqrt(0.2 / 0.04 / PLAIN))
    assert 1.0 < found < FINEST


def test_it_stays_within_its_bounds():
    assert detail(known(0.01, 0.04)) == 1.0
    assert detail(known(0.4, 0.001)) == FINEST


def test_where_most_is_in_doubt_nothing_is_concluded():
    assert detail(known(LEAST_KNOWN - 0.1, 0.001)) == FINEST
    assert detail(known(LEAST_KNOWN + 0.1, 0.001)) == 1.0


@pytest.mark.parametrize("count", [30_000, 10_000])
def test_a_comb_is_the_finer_the_more_fins_it_has(count):
    plain, fine, finest = (draws_of(comb(count, fins)).detail for fins in (2, 10, 14))
    assert plain == 1.0
    assert 1.05 < fine < finest <= FINEST


def test_it_is_about_the_same_for_fewer_points():
    assert draws_of(comb(10_000, 10)).detail == pytest.approx(draws_of(comb(40_000, 10)).detail, rel=0.1)


def test_noise_is_not_taken_for_detail():
    points = sample_part("flange", 10_000, 0)
    noise = 0.01 * np.ptp(points, axis=0).max() * np.random.default_rng(1).normal(size=points.shape)
    draws = draws_of(points + noise)
    assert (draws.normals.norm(dim=1) <= TRUSTED).float().mean() > 0.5
    assert draws.detail == 1.0


def test_a_fit_of_a_detailed_part_begins_with_shorter_waves():
    settings = resolve(method="odw-oriented", steps=1)
    start = Start.of(comb(20_000, 12), settings, torch.device("cpu"))
    plain = settings.field(torch.Generator().manual_seed(0))
    assert isinstance(start.field, Siren)
    assert isinstance(plain, Siren)
    factor = start.draws.detail
    assert factor > 1.1
    torch.testing.assert_close(start.field.weights[0], factor * plain.weights[0])
    for own, other in zip(list(start.field.weights)[1:], list(plain.weights)[1:], strict=True):
        torch.testing.assert_close(own, other)
    torch.testing.assert_close(start.field.biases[0], plain.biases[0])


def test_a_module_of_the_users_own_is_left_alone():
    module = Siren(8, 2, generator=torch.Generator().manual_seed(3))
    before = module.weights[0].clone()
    Start.of(comb(5_000, 12), resolve(method="odw-oriented", steps=1), torch.device("cpu"), module)
    torch.testing.assert_close(module.weights[0], before)

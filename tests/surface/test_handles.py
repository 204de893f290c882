"""Narrow tunnels are closed and narrow bridges cut, wide ones stay, whatever the field is a network of."""

import numpy as np
import pytest
import torch
from torch import Tensor, nn

from weingarten.crew import Crew
from weingarten.mesh import Mesh
from weingarten.metrics.topology import topology
from weingarten.surface.contour import extract
from weingarten.surface.handles import (
    Mended,
    Saddles,
    euler,
    loose,
    reach_of,
    saddles,
    simpler,
    without_handles,
)
from weingarten.surface.lattice import Lattice
from weingarten.surface.values import field_jets, field_values

LOWER, UPPER, CELLS = np.full(3, -1.0), np.full(3, 1.0), 96
LATTICE = Lattice.over(LOWER, UPPER, CELLS)
REACH = 0.03
CENTRE = 0.1 * np.array([1.0, 2.0, 3.0])


class Ring(nn.Module):
    """((ρ² + z² + R² − r²)² − 4 R² ρ²) / 8 R² r about CENTRE: zero on a torus, smooth, of slope 1 outside.

    On the axis it is (R² − r²)² / 8 R² r, a saddle that closes the hole. `sign` −1 swaps in and out: then it
    is a hollow of that shape with a rod through its hole, a bridge.
    """

    def __init__(self, hole: float, sign: float = 1.0) -> None:
        super().__init__()
        self.large, self.sign = nn.Parameter(torch.tensor(0.3)), sign
        self.small = 0.3 - hole

    def forward(self, points: Tensor) -> Tensor:
        x, y, z = (points - torch.as_tensor(CENTRE, dtype=points.dtype)).unbind(-1)
        around, own = x**2 + y**2, self.large**2 - self.small**2
        found = ((around + z**2 + own) ** 2 - 4.0 * self.large**2 * around) / (
            8.0 * self.large**2 * self.small
        )
        return self.sign * found

    @property
    def height(self) -> float:
        """f at the saddle."""
        own = 0.3**2 - self.small**2
        return self.sign * own**2 / (8.0 * 0.3**2 * self.small)


def made(values) -> Mesh:
    return extract(values, LOWER, UPPER, CELLS)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_saddle_of_a_handle_is_found(sign):
    ring = Ring(0.03, sign)
    values, jets = field_values(ring, Crew()), field_jets(ring, Crew())
    found = loose(saddles(made(values), values, jets, REACH), values, LATTICE)
    np.testing.assert_allclose(found.places, CENTRE[None], atol=0.02)  # it is flat along the axis
    np.testing.assert_allclose(found.values, [ring.height], rtol=0.05)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("hole", "genus"), [(0.03, 0), (0.12, 1)])
def test_narrow_handles_go_and_wide_ones_stay(hole, genus, sign):
    """The rod's mesh has the box's sides too: two pieces, the hollow and the box."""
    ring = Ring(hole, sign)
    values = field_values(ring, Crew())
    before = made(values)
    assert topology(before).genus == 1
    after = without_handles(before, made, values, field_jets(ring, Crew()), REACH, LATTICE)
    assert topology(after).genus == genus
    assert topology(after).components == topology(before).components
    assert (after is before) == (genus == 1)
    far = np.linalg.norm(after.vertices - CENTRE, axis=1) > 0.06
    assert np.isin(after.vertices[far], before.vertices).all()


def test_of_a_mesh_without_handles_nothing_is_asked():
    def fail(*_):
        raise AssertionError

    ball = made(lambda points: points.norm(dim=1) - 0.5)
    assert without_handles(ball, fail, fail, fail, REACH, LATTICE) is ball


def test_what_comes_apart_or_has_no_fewer_handles_is_not_simpler():
    ring, pair = made(field_values(Ring(0.12), Crew())), Mesh(np.empty((0, 3)), np.empty((0, 3), np.int64))
    ball = made(lambda points: points.norm(dim=1) - 0.5)
    both = made(lambda points: torch.minimum((points - 0.5).norm(dim=1), (points + 0.5).norm(dim=1)) - 0.2)
    assert simpler(ball, ring)
    assert not simpler(ring, ball)
    assert not simpler(ring, ring)
    assert not simpler(both, ring)
    assert not simpler(pair, ring)


def test_a_mended_field_is_beyond_zero_at_its_saddles_and_the_same_elsewhere():
    places = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]])
    mended = Mended(lambda points: points[:, 1] + 0.003, Saddles(places, np.array([0.003, -0.002])), 0.01)
    asked = torch.tensor([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.016], [0.25, 0.1, 0.0]])
    np.testing.assert_allclose(mended(asked), [-0.003, 0.008, 0.003, 0.103], atol=1e-7)


def test_euler_characteristics():
    solid = np.zeros((7, 7, 7), dtype=bool)
    solid[1:6, 1:6, 1:6] = True
    assert euler(solid) == 1
    tunnel = solid.copy()
    tunnel[:, 3, 3] = False
    assert euler(tunnel) == 0
    hollow = solid.copy()
    hollow[3, 3, 3] = False
    assert euler(hollow) == 2
    apart = solid.copy()
    apart[3] = False
    assert euler(apart) == 2


def test_the_reach_is_half_the_distance_of_points_or_less():
    line = np.zeros((100, 3))
    line[:, 0] = np.linspace(0.0, 0.4, 100)
    step = 0.4 / 99
    assert reach_of(line, 1.0) == pytest.approx(0.5 * step)
    assert reach_of(line, step) == pytest.approx(0.25 * step)
    assert reach_of(10.0 * line, 1.0) == 0.005

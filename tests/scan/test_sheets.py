"""Two sides of a thin wall are two sheets, with opposite normals; one smooth sheet is never two."""

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree

from weingarten.calculus.exact import Box, Difference
from weingarten.frame import Frame
from weingarten.samples.parts import PARTS, Part, sample_part, sample_solid
from weingarten.scan.draws import REACH
from weingarten.scan.facets import facets
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.orientation import NEIGHBOURS, OTHERS
from weingarten.scan.oriented_draws import OrientedDraws
from weingarten.scan.pace import CROWDED, SLOW, pace
from weingarten.scan.sheets import NOTABLE, Sheets


def faces(gap, count=4000, seed=0):
    """Points on two squares of side 1, and their normals up."""
    points = np.random.default_rng(seed).random((count, 3))
    points[:, 2] = np.where(np.arange(count) % 2, gap, 0.0)
    return points, np.tile([0.0, 0.0, 1.0], (count, 1))


def sheets(points, normals):
    near = KDTree(points).query(points, k=NEIGHBOURS + 1)[1][:, 1:]
    return Sheets.of(points, normals, near)


def test_neighbours_across_a_gap_are_on_another_sheet_and_no_others():
    points, normals = faces(0.02)
    found = sheets(points, normals)
    other = (points[found.near][:, :, 2] > 0.01) != (points[:, 2] > 0.01)[:, None]
    assert not found.across[~other].any()
    far = np.linalg.norm(points[found.near] - points[:, None], axis=-1) > 0.08 - 1e-3
    assert found.across[other & ~far].all()
    assert found.crowd > 0.9
    assert found.apart == pytest.approx(0.02)
    alone = sheets(*faces(0.3))
    assert alone.crowd == 0.0
    assert alone.apart == np.inf


def test_a_few_points_are_no_sheet():
    points, normals = faces(0.3)
    stray = np.linalg.norm(points - [0.5, 0.5, 0.0], axis=1).argsort()[:40]
    points[stray, 2] += 0.02
    found = sheets(points, normals)
    assert 0.0 < found.crowd < NOTABLE
    assert found.apart == np.inf


def test_a_place_is_heard_by_the_sheet_that_it_stands_before():
    points, normals = faces(0.006)
    random = np.random.default_rng(1)
    places = np.column_stack([random.uniform(0.1, 0.9, (2000, 2)), random.uniform(0.008, 0.02, 2000)])
    nearest = KDTree(points).query(places)[1]
    before = sheets(points, normals).before(places, nearest)
    mistaken = (points[nearest, 2] == 0.0).mean()
    assert mistaken > 0.2
    assert (points[before, 2] == 0.0).mean() < 0.2 * mistaken
    assert (before == nearest)[points[nearest, 2] > 0.0].all()


@pytest.mark.parametrize("name", ["flange", "bracket", "block"])
@pytest.mark.parametrize("shake", [0.0, 2e-4])
def test_an_ordinary_part_has_hardly_any(name, shake):
    """Nor with scatter that is too little to be told as noise."""
    points = sample_part(name, 20_000, 0)
    points += shake * np.ptp(points, axis=0).max() * np.random.default_rng(0).normal(size=points.shape)
    near = KDTree(points).query(points, k=OTHERS + 1)[1][:, 1:]
    assert Sheets.of(points, facets(points, near).normals, near[:, :NEIGHBOURS]).crowd < 0.01


@pytest.mark.parametrize("radius", [0.05, 1.0])
def test_a_smooth_sheet_is_one(radius):
    drawn = np.random.default_rng(0).normal(size=(300, 3))
    normals = drawn / np.linalg.norm(drawn, axis=1)[:, None]
    assert sheets(radius * normals, normals).crowd == 0.0


def draws_of(points):
    unit = Frame.of(points).to_unit(points)
    tree = KDTree(unit)
    return OrientedDraws(unit, tree, FreeSpace.of(unit, tree, REACH), torch.Generator().manual_seed(0))


def tray():
    """Open at the top, its wall half as thick as points are apart: nothing of it is known to be inside."""
    outer, inner = Box((0.0, 0.0, 0.1), (0.5, 0.3, 0.1)), Box((0.0, 0.0, 0.155), (0.495, 0.295, 0.15))
    solid = Difference(outer, inner)
    return sample_solid(Part(solid, (0.0, 0.0, 0.1), (0.5, 0.3, 0.1), 0, ""), 30_000, 0), solid


def test_the_inside_of_a_tray_is_told_by_its_outside():
    points, solid = tray()
    draws = draws_of(points)
    normals = draws.normals.double().numpy()
    trust = np.linalg.norm(normals, axis=1)
    step = 0.002 * normals / np.maximum(trust, 1e-9)[:, None]
    outward = (solid(torch.from_numpy(points + step)) > solid(torch.from_numpy(points - step))).numpy()
    assert (trust > 0.3).mean() > 0.75
    assert outward[trust > 0.3].mean() > 0.995
    told = draws.distance.numpy()
    true = solid(torch.from_numpy(Frame.of(points).to_world(draws.pool.double().numpy()))).numpy()
    known = np.isfinite(told) & (told != 0.0)
    assert (np.sign(told) == np.sign(true))[known].mean() > 0.99


def test_only_a_crowded_surface_is_learnt_slowly():
    assert pace(sheets(*faces(0.02))) == SLOW
    assert pace(sheets(*faces(0.3))) == 1.0
    assert draws_of(tray()[0]).pace == SLOW
    assert {draws_of(sample_part(name, 10_000, 0)).pace for name in PARTS} == {1.0}
    assert 0.1 < CROWDED < 0.7

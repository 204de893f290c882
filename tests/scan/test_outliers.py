"""Outliers are found and points of the part are not; of very many points some are judged."""

import numpy as np
import pytest

from weingarten.errors import CloudError
from weingarten.samples.parts import sample_part
from weingarten.scan import outliers as module
from weingarten.scan.flaws import PROBE, flawed, uneven
from weingarten.scan.outliers import outliers
from weingarten.scan.preparation import AS_GIVEN, AS_SCANNED
from weingarten.scan.sampling import corrupt


def damaged(name, share, count=20_000, noise=0.0):
    """A bundled part with so many outliers, which they are, and how far each is from where it was."""
    points = sample_part(name, count, 0)
    sigma = noise * float(np.linalg.norm(np.ptp(points, axis=0)))
    found = corrupt(points, sigma, share, 1)
    moved = np.linalg.norm(found - points, axis=1)
    return found, moved > max(1e-9, 6 * sigma)


@pytest.mark.parametrize("name", ["flange", "bracket", "block"])
@pytest.mark.parametrize("count", [1000, 20_000])
def test_a_clean_part_keeps_its_points(name, count):
    assert outliers(sample_part(name, count, 0), 0).mean() <= 0.002


@pytest.mark.parametrize("name", ["flange", "bracket", "block"])
@pytest.mark.parametrize("share", [0.01, 0.05, 0.1])
def test_outliers_are_found(name, share):
    points, strange = damaged(name, share)
    found = outliers(points, 0)
    assert found[strange].mean() > 0.75  # the others lie on the part or next to it
    assert found[~strange].mean() < 0.003


def test_noise_is_not_taken_for_outliers():
    points, _ = damaged("bracket", 0.0, noise=0.005)
    assert outliers(points, 0).mean() < 0.005


def test_a_part_ten_times_as_dense_at_one_end_keeps_its_points():
    def draw(count, seed):
        return sample_part("bracket", count, seed)

    points = flawed(draw, 20_000, [uneven(10.0, draw(PROBE, 0), (1,))], (2,))
    assert outliers(points, 0).mean() < 0.003


def test_one_far_away_does_not_shrink_the_part():
    points = np.concatenate([sample_part("flange", 5000, 0), [[1e5, 0.0, 0.0]]])
    kept, notes = AS_SCANNED.cleaned(points, 0)
    assert np.ptp(kept, axis=0).max() < 100.0
    assert "Left out as outliers" in notes[0]
    assert AS_GIVEN.cleaned(points, 0) == (points, ())


def test_of_many_points_the_rest_are_as_the_nearest_that_was_judged(monkeypatch):
    points, strange = damaged("flange", 0.05)
    monkeypatch.setattr(module, "thinned", lambda points, seed: points[::2])
    found = outliers(points, 0)
    assert found.shape == strange.shape
    judged = outliers(points[::2], 0)[strange[::2]].mean()
    assert judged > 0.5
    assert found[strange].mean() > judged - 0.02
    assert found[~strange].mean() < 0.01


def test_a_cloud_of_outliers_holds_no_part():
    cleaned = AS_SCANNED.__class__(lambda points, seed: np.ones(len(points), dtype=bool), AS_SCANNED.settle)
    with pytest.raises(CloudError, match="belong to no surface"):
        cleaned.cleaned(sample_part("block", 200, 0), 0)


def test_strays_beside_a_plane_do_not_make_it_a_part():
    generator = np.random.default_rng(0)
    plane = np.hstack([generator.random((3000, 2)), np.zeros((3000, 1))])
    strays = np.array([[0.2, 0.3, 0.9], [0.7, 0.1, 0.8], [0.4, 0.9, -0.7], [0.9, 0.6, 0.95]])
    with pytest.raises(CloudError, match="points that are no outliers lie in one plane"):
        AS_SCANNED.cleaned(np.vstack([plane, strays]), 0)

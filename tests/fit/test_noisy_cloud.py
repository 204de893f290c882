"""From a noisy cloud to the draws of a fit: settled and weighed for our methods, as given for others."""

import numpy as np
import torch

from weingarten.samples.parts import sample_part
from weingarten.scan.interleaved import side_by_side
from weingarten.scan.sample import SURFACE, Sample
from weingarten.scan.sampling import corrupt
from weingarten.settings import resolve
from weingarten.start import Start
from weingarten.terms.curriculum import CURRICULUM_SURFACE
from weingarten.terms.dirichlet import DIRICHLET

CPU = torch.device("cpu")
POINTS = sample_part("bracket", 6000, 0)
DIAGONAL = float(np.linalg.norm(np.ptp(POINTS, axis=0)))
NOISY = corrupt(POINTS, 0.0025 * DIAGONAL, 0.03, 1)


def start(points, method):
    return Start.of(points, resolve(method=method, steps=1), CPU)


def test_ours_settles_and_weighs_and_leaves_outliers_out():
    found = start(NOISY, "odw-oriented")
    assert 5700 < len(found.cloud) < 5950
    assert any("Left out as outliers" in note for note in found.notes)
    assert not np.array_equal(found.unit, found.frame.to_unit(found.cloud))
    sample = found.draws(500, found.generator)[SURFACE]
    assert sample.weight is not None
    assert 0.0 < float(sample.weight.min()) < float(sample.weight.max()) <= 1.0


def test_a_clean_cloud_is_fitted_as_it_is():
    found = start(POINTS, "odw-oriented")
    np.testing.assert_array_equal(found.unit, found.frame.to_unit(found.cloud))
    assert found.draws(500, found.generator)[SURFACE].weight is None


def test_published_methods_take_the_points_as_given():
    found = start(NOISY, "odw-paper")
    assert len(found.cloud) == len(NOISY)
    np.testing.assert_array_equal(found.unit, found.frame.to_unit(NOISY))
    assert found.draws(500, found.generator)[SURFACE].weight is None


def test_data_terms_count_points_by_their_weight():
    points = torch.randn(50, 3)
    weight = torch.rand(50)
    for term in (DIRICHLET, CURRICULUM_SURFACE):
        jet = torch.nn.Linear(3, 1)
        plain = term.residual(jet_of(jet, points), Sample(points))
        weighed = term.residual(jet_of(jet, points), Sample(points, weight=weight))
        torch.testing.assert_close(weighed, weight * plain)


def jet_of(module, points):
    """Values alone."""
    from weingarten.calculus.jet import Jet

    return Jet(module(points).squeeze(-1))


def test_side_by_side_a_clean_part_counts_fully_beside_a_noisy_one():
    points = torch.zeros(4, 3)
    joined = side_by_side([Sample(points), Sample(points, weight=torch.full((4,), 0.5))])
    assert joined.weight is not None
    assert joined.weight.tolist() == [[1.0, 0.5]] * 4
    assert side_by_side([Sample(points), Sample(points)]).weight is None

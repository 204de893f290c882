"""Noisy points come nearer to their surface, clean ones stay where they are, and edges are let be."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest
from weingarten.samples.parts import part_mesh, sample_part
from weingarten.scan.noise import Noise, noise_of
from weingarten.scan.settled import FULL_WEIGHT, settled


def unit_part(name, deviation, count=20_000):
    """A bundled part and its surface in the unit frame, with Gaussian noise of this standard deviation."""
    points, mesh = sample_part(name, count, 0), part_mesh(name)
    frame = Frame.of(points)
    unit = frame.to_unit(points)
    noisy = unit + np.random.default_rng(1).normal(0, deviation, unit.shape)
    return noisy, Mesh(frame.to_unit(mesh.vertices), mesh.faces)


def test_without_noise_the_points_are_the_same_array_and_count_fully():
    points = sample_part("block", 1000, 0)
    found = settled(points, Noise())
    assert found.points is points
    assert found.weight is None
    assert found.normals is None


@pytest.mark.parametrize("name", ["flange", "bracket"])
@pytest.mark.parametrize("deviation", [0.004, 0.01])
def test_points_come_nearer(name, deviation):
    points, mesh = unit_part(name, deviation)
    found = settled(points, noise_of(points, KDTree(points)))
    before, after = closest(mesh, points).distance, closest(mesh, found.points).distance
    assert found.flat is not None
    flat = found.flat > 0.5
    assert after.mean() < 0.65 * before.mean()
    assert after[flat].mean() < 0.4 * before[flat].mean()


def test_on_a_plane_noise_is_averaged_away_and_normals_are_the_planes():
    random = np.random.default_rng(0)
    points = np.column_stack([random.uniform(-1, 1, (20_000, 2)), random.normal(0, 0.01, 20_000)])
    found = settled(points, Noise(0.01, 48))
    inner = np.abs(points[:, :2]).max(axis=1) < 0.9
    assert np.abs(found.points[inner, 2]).std() < 0.01 * 2.0 / np.sqrt(48)
    assert found.normals is not None
    assert np.abs(found.normals[inner, 2]).min() > 0.98
    moved = np.linalg.norm(found.points - points, axis=1)
    assert moved.max() < 0.06


def test_points_count_as_far_as_they_are_certain():
    points, mesh = unit_part("bracket", 0.01)
    found = settled(points, noise_of(points, KDTree(points)))
    weight, flat = found.weight, found.flat
    assert weight is not None
    assert flat is not None
    weight = weight.numpy()
    assert weight.max() <= 1.0
    assert weight.min() >= 0.9 * FULL_WEIGHT / found.noise.level
    off = closest(mesh, found.points).distance
    surest, least = weight > np.quantile(weight, 0.8), weight < np.quantile(weight, 0.2)
    assert off[surest].mean() < 0.5 * off[least].mean()


def test_the_same_in_any_order():
    points, _ = unit_part("block", 0.005, 3000)
    order = np.random.default_rng(2).permutation(len(points))
    noise = noise_of(points, KDTree(points))
    one, other = settled(points, noise), settled(points[order], noise)
    np.testing.assert_allclose(one.points[order], other.points, atol=1e-9)


@pytest.mark.parametrize("deviation", [0.001, 0.004])
def test_the_data_term_of_the_exact_field_is_foretold(deviation):
    """Of a plane, whose distance is |z|: where all is certain and where most points count less."""
    generator = np.random.default_rng(0)
    points = np.column_stack([generator.uniform(-1, 1, (8000, 2)), deviation * generator.normal(size=8000)])
    found = settled(points, noise_of(points, KDTree(points)))
    assert found.weight is not None
    exact = float((found.weight.numpy() * np.abs(found.points[:, 2])).mean())
    assert found.misfit == pytest.approx(exact, rel=0.3)
    assert settled(points, Noise()).misfit is None

"""Signs of normals: right where witnesses reach, carried on where none does, silent where they quarrel."""

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree

from weingarten.calculus.exact import Sphere, Torus
from weingarten.frame import Frame
from weingarten.samples.parts import PARTS, sample_part
from weingarten.scan.draws import REACH, SignedDraws, positions
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.orientation import evidence, orientation


def sphere(count, seed=0):
    drawn = np.random.default_rng(seed).normal(size=(count, 3))
    return drawn / np.linalg.norm(drawn, axis=1)[:, None]


def plate(count, thickness, seed=0):
    """A square of side 2, points on both faces and the rim."""
    random = np.random.default_rng(seed)
    rim = round(count * 4 * 2 * thickness / (8 + 8 * thickness))
    points = random.uniform(-1.0, 1.0, (count, 3))
    points[:, 2] = np.where(random.random(count) < 0.5, 0.5, -0.5) * thickness
    points[:rim, 2] = random.uniform(-0.5, 0.5, rim) * thickness
    axis, side = random.integers(0, 2, rim), random.choice([-1.0, 1.0], rim)
    points[np.arange(rim), axis] = side
    return points


def witnesses(points, reference, shift, count=4000, seed=1):
    """Points beside some of the cloud's, `shift` along their outward normals, which are told."""
    chosen = np.random.default_rng(seed).integers(0, len(points), count)
    return points[chosen] + shift * reference[chosen], np.full(count, np.sign(shift)), chosen


def found(points, *told):
    return orientation(points, KDTree(points), *told).normals


def by_free_space(points):
    """With the witnesses that the pool of a fit has."""
    unit = Frame.of(points).to_unit(points)
    tree = KDTree(unit)
    space = FreeSpace.of(unit, tree, REACH)
    draws = SignedDraws(unit, tree, space, torch.Generator().manual_seed(0))
    known = draws.nearest >= 0
    signs = np.sign(draws.distance.numpy()[known]).astype(np.float64)
    return unit, orientation(unit, tree, positions(draws.pool)[known], signs, draws.nearest[known]).normals


@pytest.mark.parametrize("shift", [0.1, -0.1])
def test_a_sphere_has_its_normals_whichever_side_is_told(shift):
    points = sphere(3000)
    normals = found(points, *witnesses(points, points, shift))
    trust = np.linalg.norm(normals, axis=1)
    cosine = (normals * points).sum(1) / trust
    assert cosine.min() > 0.98
    assert trust.max() <= 1.0
    assert np.median(trust) > 0.9


def test_one_witness_is_enough_for_a_whole_surface():
    points = sphere(3000)
    normals = found(points, 1.2 * points[:1], np.ones(1), np.zeros(1, dtype=np.int64))
    assert ((normals * points).sum(1) > 0).all()


def test_without_witnesses_nothing_is_trusted():
    points = sphere(500)
    nobody = np.zeros((0, 3)), np.zeros(0), np.zeros(0, dtype=np.int64)
    np.testing.assert_array_equal(found(points, *nobody), np.zeros_like(points))


def test_witnesses_that_contradict_each_other_are_not_believed():
    points = sphere(2000)
    outside, inside = witnesses(points, points, 0.1), witnesses(points, points, 0.1)
    told = [np.concatenate(pair) for pair in zip(outside, inside, strict=True)]
    told[1][len(outside[1]) :] = -1.0
    assert np.abs(found(points, *told)).max() < 1e-6


def test_evidence_is_taken_from_in_front_and_from_behind_alone():
    points, normals = np.zeros((1, 3)), np.array([[0.0, 0.0, -1.0]])

    def told(at, sign):
        return evidence(points, normals, np.array([at]), np.array([sign]), np.array([0]))[0]

    assert told([0.0, 0.0, 2.0], 1.0) == -1.0
    assert told([0.0, 0.0, 2.0], -1.0) == 1.0
    assert told([0.0, 0.0, -0.1], 1.0) == 1.0
    assert told([1.0, 0.0, 0.1], 1.0) == 0.0


@pytest.mark.parametrize("part", ["flange", "bracket", "block"])
@pytest.mark.parametrize("seed", [0, 1])
def test_free_space_orients_the_bundled_parts(part, seed):
    """Against exact surfaces: what is trusted is right, and most is trusted."""
    points = sample_part(part, 20_000, seed)
    at = torch.from_numpy(points).requires_grad_(True)
    (slope,) = torch.autograd.grad(PARTS[part].solid(at).sum(), at)
    _, normals = by_free_space(points)
    trust = np.linalg.norm(normals, axis=1)
    cosine = (normals * slope.numpy()).sum(1) / np.maximum(trust, 1e-12)
    assert (cosine[trust > 0.3] > 0).mean() > 0.9995
    assert (trust > 0.3).mean() > 0.6


@pytest.mark.parametrize("thickness", [0.045, 0.06])
def test_a_plate_too_thin_to_have_an_inside_is_oriented(thickness):
    points = plate(20_000, thickness)
    unit, normals = by_free_space(points)
    space = FreeSpace.of(unit, KDTree(unit), REACH)
    assert space.known_inside == 0.0
    faces = (np.abs(points[:, :2]).max(axis=1) < 0.95) & (np.linalg.norm(normals, axis=1) > 0.3)
    assert faces.mean() > 0.5
    assert (np.sign(normals[faces, 2]) == np.sign(points[faces, 2])).mean() > 0.9995


@pytest.mark.parametrize("shape", [Sphere(radius=0.8), Torus(ring=0.6, tube=0.25)], ids=["sphere", "torus"])
def test_noise_lessens_trust(shape):
    random = np.random.default_rng(0)
    points = random.uniform(-1.0, 1.0, (200_000, 3))
    points = points[np.abs(shape(torch.from_numpy(points)).numpy()) < 0.02]
    clean = []
    for noise in (0.0, 0.3, 1.0):
        at = torch.from_numpy(points).requires_grad_(True)
        value = shape(at)
        (slope,) = torch.autograd.grad(value.sum(), at)
        own = points - (1.0 - noise) * value.detach().numpy()[:, None] * slope.numpy()
        _, normals = by_free_space(own)
        clean.append(np.linalg.norm(normals, axis=1).mean())
    assert clean == sorted(clean, reverse=True)
    assert clean[0] > 2 * clean[-1]


def test_a_rotation_turns_the_normals():
    points = sphere(800)
    told = witnesses(points, points, 0.1)
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turned = found(points @ turn.T, told[0] @ turn.T, *told[1:])
    np.testing.assert_allclose(turned, found(points, *told) @ turn.T, atol=1e-6)

"""Planes of a rounded edge come back as those beside it; those of a smooth surface stay."""

import numpy as np
import pytest

from weingarten.surface.planes import BENT, Planes, unrounded

STEP = 0.004


def rounded_edge(radius, length=0.08, width=0.06):
    """Points, normals and bend of two planes x = 0, y = 0 (outside is negative) joined by a round."""
    along = np.arange(-length, length, STEP)
    straight = np.arange(radius + STEP / 2, width, STEP)
    turn = np.arange(0.0, np.pi / 2, STEP / radius) + STEP / radius / 2
    turn = turn[turn < np.pi / 2]
    flat = np.stack([0 * straight, -straight], axis=1), np.tile([1.0, 0.0], (len(straight), 1))
    round_normals = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    arc = radius * (round_normals - 1.0), round_normals
    other = flat[0][:, ::-1], flat[1][:, ::-1]
    points, normals = (np.concatenate(rows) for rows in zip(flat, arc, other, strict=True))
    bend = np.concatenate([0 * straight, np.full(len(turn), 1 / radius), 0 * straight])
    layers = [np.column_stack([points, np.full(len(points), z)]) for z in along]
    turned = np.tile(np.column_stack([normals, np.zeros(len(normals))]), (len(along), 1))
    return Planes(np.concatenate(layers), turned, np.tile(bend, len(along)))


@pytest.mark.parametrize("radius", [0.006, 0.012])
def test_a_rounded_edge_is_two_planes_again(radius):
    planes = rounded_edge(radius)
    points, normals = unrounded(planes)
    inner = np.abs(planes.points[:, 2]) < 0.05
    before = np.minimum(*np.abs(planes.points[inner, :2].T)).max()
    off = np.abs((normals * points).sum(axis=1))[inner]
    assert off.max() < 0.3 * before
    square = np.maximum(np.abs(normals[inner, 0]), np.abs(normals[inner, 1]))
    assert np.median(square) > 0.999
    assert (square > 0.98).mean() > 0.9


def test_a_wide_round_of_45_degrees_is_an_edge_where_its_planes_are_known():
    """Nothing flat is within reach: without the known planes the round stays."""
    turn = np.linspace(0.0, np.pi / 4, 13)
    radius, along = 0.05, np.arange(-0.06, 0.06, STEP)
    normals = np.column_stack([np.sin(turn), np.cos(turn), 0 * turn])
    arc = radius * (normals - [0.0, 1.0, 0.0])
    layers = np.concatenate([arc + np.array([0.0, 0.0, z]) for z in along])
    planes = Planes(layers, np.tile(normals, (len(along), 1)), np.full(len(layers), 1 / radius))
    sides = np.random.default_rng(0).uniform([-0.04, -0.06], [0.0, 0.06], (200, 2))
    first = np.column_stack([sides[:, 0], 0 * sides[:, 0], sides[:, 1]])
    c = np.sqrt(0.5)
    corner = np.array([radius * np.tan(np.pi / 8), 0.0, 0.0])
    second = corner - (sides[:, :1] - corner[0]) * np.array([c, -c, 0.0]) + sides[:, 1:] * [0.0, 0.0, 1.0]
    flat = np.array([[0.0, 1.0, 0.0], [c, c, 0.0]])
    known = Planes(np.concatenate([first, second]), flat.repeat(200, axis=0), np.zeros(400))

    def blurred(found):
        return np.degrees(np.arccos(np.clip((found @ flat.T).max(axis=1), -1.0, 1.0)))

    inner = np.abs(layers[:, 2]) < 0.04
    before = np.median(blurred(unrounded(planes)[1][inner]))
    points, turned = unrounded(planes, known)
    assert np.median(blurred(turned[inner])) < 0.3 * before
    nearer = flat[(turned[inner] @ flat.T).argmax(axis=1)]
    off, was = (np.abs(((at[inner] - corner) * nearer).sum(axis=1)) for at in (points, layers))
    assert np.median(off) < 0.4 * np.median(was)


def test_a_plane_is_left_alone():
    draw = np.random.default_rng(0)
    points = np.concatenate([draw.uniform(-0.5, 0.5, (500, 2)), np.zeros((500, 1))], axis=1)
    planes = Planes(points, np.tile([0.0, 0.0, 1.0], (500, 1)), np.full(500, 0.5 * BENT))
    found = unrounded(planes)
    assert np.array_equal(found[0], points)
    assert np.array_equal(found[1], planes.normals)


@pytest.mark.parametrize("radius", [0.03, 0.1])
def test_points_of_a_sphere_stay_on_it(radius):
    draw = np.random.default_rng(1)
    normals = draw.normal(size=(int(4 * np.pi * radius**2 / STEP**2), 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    planes = Planes(radius * normals, normals, np.full(len(normals), 1 / radius))
    points, turned = unrounded(planes)
    assert np.abs(np.linalg.norm(points, axis=1) - radius).mean() < 0.01 * radius
    assert (turned * normals).sum(axis=1).min() > 0.9


def test_a_point_without_neighbours_stays():
    planes = Planes(np.zeros((1, 3)), np.array([[0.0, 1.0, 0.0]]), np.array([1e6]))
    points, normals = unrounded(planes)
    assert np.isfinite(points).all()
    assert np.array_equal(normals, planes.normals)

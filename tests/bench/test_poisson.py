"""Screened Poisson reconstruction of shapes known exactly, and what it says when it cannot be done."""

import sys
from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
import trimesh

from weingarten.bench.poisson import NEIGHBOURS, oriented_normals, screened_poisson
from weingarten.errors import CloudError, FitError, MissingExtraError, OptionError
from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest
from weingarten.metrics.normals import face_normals
from weingarten.metrics.topology import topology
from weingarten.scan.sampling import generator, sample_surface

DEPTH = 5


def on_sphere(count: int, centre: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    directions = generator(0).standard_normal((count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True) + np.array(centre)


def box() -> Mesh:
    shape = trimesh.creation.box((1.0, 1.6, 0.7))
    return Mesh(np.array(shape.vertices), np.array(shape.faces, dtype=np.int64))


@pytest.fixture
def solver() -> None:
    """Skips what needs the extra, without a warning of its import."""
    pytest.importorskip("gpytoolbox_bindings")


def test_normals_of_a_sphere_point_outward():
    points = on_sphere(2000)
    assert np.einsum("nd,nd->n", oriented_normals(points), points).min() > 0.99


@pytest.mark.parametrize("neighbours", [NEIGHBOURS, 20])
def test_normals_of_a_box_point_outward(neighbours: int):
    truth = box()
    points, faces = sample_surface(truth, 10_000, 0)
    normals = oriented_normals(points, neighbours)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    cosines = np.einsum("nd,nd->n", normals, face_normals(truth)[faces])
    assert cosines.min() > -0.1
    assert np.mean(cosines > 0.999) > 0.7


def test_every_component_has_a_sign_of_its_own():
    ball = on_sphere(500)
    for centre in ((3.0, 0.0, 0.0), (0.0, 0.0, 3.0)):
        normals = oriented_normals(np.concatenate([ball, on_sphere(500, centre)]))
        assert (np.einsum("nd,nd->n", normals, np.concatenate([ball, ball])) > 0.9).all()


def test_signs_agree_along_a_tree_found_edge_by_edge():
    points = on_sphere(300) * np.array([1.0, 0.6, 0.3])
    normals = oriented_normals(points, 8)
    np.testing.assert_array_equal(normals, normals * slow_signs(points, normals, 8)[:, None])


def slow_signs(points: np.ndarray, normals: np.ndarray, neighbours: int) -> np.ndarray:
    """Prim's algorithm from the highest point, all pairs of neighbours."""
    distance = np.linalg.norm(points[:, None] - points, axis=-1)
    near = np.argsort(distance, axis=1)[:, 1 : neighbours + 1]
    linked = np.zeros(distance.shape, dtype=bool)
    np.put_along_axis(linked, near, True, axis=1)
    linked |= linked.T
    alike = normals @ normals.T
    signs, start = np.zeros(len(points)), int(points[:, 2].argmax())
    signs[start] = np.sign(normals[start, 2])
    while not signs.all():
        frontier = linked & (signs != 0)[:, None] & (signs == 0)
        cost = np.where(frontier, 1 - np.abs(alike), np.inf)
        parent, child = np.unravel_index(int(cost.argmin()), cost.shape)
        signs[child] = signs[parent] * np.sign(alike[parent, child])
    return signs


@pytest.mark.usefixtures("solver")
def test_a_sphere():
    mesh = screened_poisson(on_sphere(3000), DEPTH)
    found = topology(mesh)
    assert (found.watertight, found.oriented, found.components, found.genus) == (True, True, 1, 0)
    assert found.volume == pytest.approx(4 / 3 * np.pi, rel=0.01)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1, atol=0.02)


@pytest.mark.usefixtures("solver")
def test_a_box():
    truth = box()
    mesh = screened_poisson(sample_surface(truth, 10_000, 0)[0], 6)
    found = topology(mesh)
    assert (found.watertight, found.components, found.genus) == (True, 1, 0)
    assert found.volume == pytest.approx(1.0 * 1.6 * 0.7, rel=0.01)
    away = closest(truth, mesh.vertices).distance
    assert away.mean() < 0.005
    assert away.max() < 0.05


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("depth", [3, 4, 6])
def test_cells_are_as_wide_as_in_kazhdans_program(depth: int):
    """Vertices lie on edges of cells, so that two of their three coordinates are shared with many others."""
    points = on_sphere(5000) * np.array([1.0, 0.8, 0.6])
    heights, uses = np.unique(screened_poisson(points, depth).vertices[:, 2].round(6), return_counts=True)
    cell = 1.1 * np.ptp(points[:, 0]) / 2**depth
    assert np.diff(heights[uses > 3]).min() == pytest.approx(cell, rel=1e-4)


@pytest.mark.usefixtures("solver")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_sample_without_a_normal_counts_for_nothing():
    from gpytoolbox import point_cloud_to_mesh

    points, inside = on_sphere(1000), 0.3 * on_sphere(10)
    padded = np.concatenate([points, inside]), np.concatenate([points, np.zeros((10, 3))])
    plain, same = (
        point_cloud_to_mesh(*samples, psr_depth=6) for samples in ((points, points.copy()), padded)
    )
    np.testing.assert_array_equal(plain[0], same[0])
    np.testing.assert_array_equal(plain[1], same[1])


@pytest.mark.usefixtures("solver")
def test_the_same_points_give_the_same_mesh():
    points = sample_surface(box(), 2000, 0)[0]
    first, second = screened_poisson(points, DEPTH), screened_poisson(points.copy(), DEPTH)
    np.testing.assert_array_equal(first.vertices, second.vertices)
    np.testing.assert_array_equal(first.faces, second.faces)


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize(("size", "offset"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e6), (1e-3, 1e3)])
def test_the_surface_follows_scale_and_offset(size: float, offset: float):
    points = sample_surface(box(), 2000, 0)[0]
    plain, moved = screened_poisson(points, DEPTH), screened_poisson(points * size + offset, DEPTH)
    back = Mesh((moved.vertices - offset) / size, moved.faces)
    assert closest(plain, back.vertices).distance.max() < 1e-3
    assert topology(back).volume == pytest.approx(topology(plain).volume, rel=1e-3)


def library(solve: Callable[..., tuple[np.ndarray, np.ndarray]]) -> ModuleType:
    """What stands in for gpytoolbox."""
    module = ModuleType("gpytoolbox")
    module.point_cloud_to_mesh = solve
    return module


def test_an_inside_out_surface_is_turned(monkeypatch: pytest.MonkeyPatch):
    truth = box()
    monkeypatch.setitem(
        sys.modules, "gpytoolbox", library(lambda *_, **__: (truth.vertices, truth.faces[:, ::-1]))
    )
    assert topology(screened_poisson(on_sphere(200))).volume > 0


def test_no_surface_is_said(monkeypatch: pytest.MonkeyPatch):
    nothing = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32)
    monkeypatch.setitem(sys.modules, "gpytoolbox", library(lambda *_, **__: nothing))
    with pytest.raises(FitError, match="no surface through the 200 points"):
        screened_poisson(on_sphere(200))


def test_a_solver_that_fails_is_said(monkeypatch: pytest.MonkeyPatch):
    def failing(*_: object, **__: object) -> tuple[np.ndarray, np.ndarray]:
        raise RuntimeError("out of nodes")

    monkeypatch.setitem(sys.modules, "gpytoolbox", library(failing))
    with pytest.raises(FitError, match="200 points: out of nodes"):
        screened_poisson(on_sphere(200))


def test_without_the_extra(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "gpytoolbox", None)
    with pytest.raises(MissingExtraError, match=r'pip install "weingarten\[bench\]"'):
        screened_poisson(on_sphere(200))


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("count", [0, 1, 99])
def test_too_few_points(count: int):
    with pytest.raises(CloudError, match="distinct points; give at least 100"):
        screened_poisson(on_sphere(200)[:count])


@pytest.mark.usefixtures("solver")
def test_a_flat_cloud():
    with pytest.raises(CloudError, match="in one plane"):
        screened_poisson(on_sphere(200) * np.array([1.0, 1.0, 0.0]))


def test_fewer_points_than_neighbours():
    with pytest.raises(CloudError, match="10 points, too few for 10 neighbours"):
        oriented_normals(on_sphere(10), 10)
    with pytest.raises(OptionError, match="at least 3 neighbours; got 2"):
        oriented_normals(on_sphere(10), 2)


@pytest.mark.parametrize("depth", [2, 11])
def test_a_depth_out_of_range(depth: int):
    with pytest.raises(OptionError, match=f"from 3 to 10; got {depth}"):
        screened_poisson(on_sphere(200), depth)

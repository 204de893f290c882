"""The protocols against closed forms, slow reference implementations, and abc25's recorded ceilings."""

import csv
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh

from weingarten.errors import InputError
from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest
from weingarten.metrics.normals import alignment, elementwise_alignment, face_normals
from weingarten.metrics.protocol import EXACT, PROTOCOLS, PUBLISHED, Exact, Published, f1, unit_cube
from weingarten.scan.sampling import sample_surface

ABC25 = Path(os.environ.get("WEINGARTEN_ABC25", Path(__file__).parents[2] / "../shared/data/abc25"))


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


BOX = as_mesh(trimesh.creation.box((1, 0.5, 0.25)))
SPHERE = as_mesh(trimesh.creation.icosphere(4))
TURN = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))[:3, :3]


def similar(mesh: Mesh, scale: float = 1.0, turn=None, shift: float = 0.0) -> Mesh:
    turned = mesh.vertices @ (np.eye(3) if turn is None else turn).T
    return Mesh(scale * turned + shift, mesh.faces)


def test_names_and_table():
    assert PROTOCOLS == {"published": PUBLISHED, "exact": EXACT}
    assert (PUBLISHED.name, EXACT.name) == ("published-1", "exact-1")


def test_exact_of_identical_meshes():
    found = EXACT.evaluate(BOX, BOX)
    assert found.hausdorff < 1e-12
    assert (found.f1_005, found.f1_001, found.volume_ratio) == (1, 1, 1)
    assert found.normal_consistency == pytest.approx(1, abs=1e-9)
    assert (found.genus, found.euler, found.components, found.watertight) == (0, 2, 1, True)


def test_exact_of_spheres_of_two_radii():
    found = EXACT.evaluate(similar(SPHERE, 1.01), SPHERE)
    assert found.chamfer == pytest.approx(0.005, rel=0.02)
    assert found.distance_95 == pytest.approx(0.005, rel=0.02)
    assert found.hausdorff == pytest.approx(0.005, rel=0.02)
    assert found.f1_001 == 0
    assert found.volume_ratio == pytest.approx(1.01**3)
    assert found.normal_consistency > 0.999


def test_sharp_edges_of_a_box_and_the_same_a_little_larger():
    """Every edge of a cube of 1.004 is 0.002 √2 from that of the unit cube, but for its ends beyond."""
    cube = as_mesh(trimesh.creation.box((1, 1, 1)))
    same, larger = EXACT.evaluate(cube, cube), EXACT.evaluate(similar(cube, 1.004), cube)
    assert same.edge_chamfer == pytest.approx(0, abs=1e-12)
    assert same.edge_f1 == larger.edge_f1 == 1
    assert larger.edge_chamfer == pytest.approx(0.002 * np.sqrt(2), rel=2e-3)
    assert EXACT.evaluate(similar(cube, 1.02), cube).edge_f1 == 0


def test_sharp_edges_where_there_are_none():
    ball = EXACT.evaluate(SPHERE, SPHERE)
    assert (ball.edge_chamfer, ball.edge_f1) == (None, None)
    spurious, missing = EXACT.evaluate(BOX, SPHERE), EXACT.evaluate(SPHERE, BOX)
    assert (spurious.edge_chamfer, spurious.edge_f1) == (None, None)
    assert (missing.edge_chamfer, missing.edge_f1) == (None, 0.0)


def test_exact_of_a_shifted_box():
    """Shifted by δ along x: the ends are δ away, so of the points; all the others lie on the other box but
    for a strip of width δ, whose distances average δ/2."""
    shift, area = 0.02, 2 * (0.5 + 0.25 + 0.125)
    moved = Mesh(BOX.vertices + np.array([shift, 0, 0]), BOX.faces)
    ends, strip = 2 * 0.125, 2 * (0.5 + 0.25) * shift
    # The end inside the other box is nearer to a long side where it lies within δ of one.
    width, height = 0.5 - 2 * shift, 0.25 - 2 * shift
    rim = 0.125 - width * height
    inner = shift * width * height + rim * shift / 2
    # Corner pyramids of the rim are of order δ³.
    mean = (ends / 2 * shift + inner + strip * shift / 2) / area
    found = EXACT.evaluate(moved, BOX)
    assert found.chamfer == pytest.approx(mean, rel=0.02)
    assert found.hausdorff == pytest.approx(shift, rel=1e-9)
    assert found.volume_ratio == pytest.approx(1)


def test_exact_is_invariant_to_similarities():
    other = Mesh(SPHERE.vertices * [1, 1.02, 0.97], SPHERE.faces)
    small = Exact(samples=20_000)
    before = small.evaluate(other, SPHERE)
    after = small.evaluate(similar(other, 37, None, 1e4), similar(SPHERE, 37, None, 1e4))
    turned = small.evaluate(similar(other, 1, TURN), similar(SPHERE, 1, TURN))
    for name in ("chamfer", "distance_95", "hausdorff", "f1_005", "f1_001", "normal_consistency"):
        assert getattr(after, name) == pytest.approx(getattr(before, name), rel=1e-6)
        assert getattr(turned, name) == pytest.approx(getattr(before, name), rel=2e-2)


def test_exact_sees_what_the_published_protocol_forgives():
    moved = similar(BOX, 1.3, None, 5.0)
    assert EXACT.evaluate(moved, BOX).f1_005 < 0.5
    assert PUBLISHED.evaluate(moved, BOX).f1 == pytest.approx(PUBLISHED.ceiling(BOX).f1, abs=0.005)


def slow_published(mesh: Mesh, truth: Mesh, count: int) -> tuple[float, float, float]:
    """CD, F1, NC from the full matrix of distances."""
    clouds = []
    for stream, one in enumerate((mesh, truth)):
        unit = unit_cube(one, one)
        points, faces = sample_surface(unit, count, (0, stream))
        clouds.append((points, face_normals(unit)[faces]))
    (p, a), (q, b) = clouds
    matrix = np.sqrt(((p[:, None] - q[None]) ** 2).sum(axis=2))
    chamfer = (matrix.min(axis=1).mean() + matrix.min(axis=0).mean()) / 2
    precision, recall = (matrix.min(axis=1) < 0.005).mean(), (matrix.min(axis=0) < 0.005).mean()
    forth = np.abs(a * b[matrix.argmin(axis=1)]).sum(axis=1).mean()
    back = np.abs(b * a[matrix.argmin(axis=0)]).sum(axis=1).mean()
    return chamfer, 2 / (1 / precision + 1 / recall), (forth + back) / 2


def test_published_agrees_with_the_slow_reference():
    found = Published(samples=1500).evaluate(similar(BOX, 3, TURN), similar(BOX, 1, TURN, 7.0))
    expected = slow_published(similar(BOX, 3, TURN), similar(BOX, 1, TURN, 7.0), 1500)
    assert (found.chamfer, found.f1, found.normal_consistency) == pytest.approx(expected, rel=1e-12)


def test_exact_agrees_with_its_formula():
    other, small = similar(SPHERE, 1.004), Exact(samples=3000)
    found = small.evaluate(other, SPHERE)
    made, true = unit_cube(other, SPHERE), unit_cube(SPHERE, SPHERE)
    p, i = sample_surface(made, 3000, (0, 0))
    q, j = sample_surface(true, 3000, (0, 1))
    forth, back = closest(true, p), closest(made, q)
    d = np.concatenate([forth.distance, back.distance])
    a = np.abs((face_normals(made)[i] * face_normals(true)[forth.face]).sum(axis=1))
    b = np.abs((face_normals(true)[j] * face_normals(made)[back.face]).sum(axis=1))
    assert found.chamfer == pytest.approx(d.mean())
    assert found.distance_95 == pytest.approx(np.quantile(d, 0.95))
    assert found.hausdorff == pytest.approx(d.max())
    assert found.normal_consistency == pytest.approx((a.mean() + b.mean()) / 2)


def test_published_ceiling_formula():
    """A sphere in the unit cube has A = π and no edges: CD = ½ √(A/N), F1 = 1 − exp(−πτ²N/A)."""
    found = PUBLISHED.ceiling(SPHERE)
    assert found.chamfer == pytest.approx(0.5 * np.sqrt(np.pi / 1e5), rel=0.01)
    assert found.f1 == pytest.approx(1 - np.exp(-(0.005**2) * 1e5), abs=0.005)


def test_published_is_invariant_to_translation_and_scale():
    other = Mesh(SPHERE.vertices * [1, 1.1, 0.9], SPHERE.faces)
    small = Published(samples=20_000)
    before, after = small.evaluate(other, SPHERE), small.evaluate(similar(other, 1e-4, None, 3.0), SPHERE)
    assert after.chamfer == pytest.approx(before.chamfer, rel=1e-4)
    assert after.normal_consistency == pytest.approx(before.normal_consistency, rel=1e-4)


def test_alignment_of_random_normals():
    random = np.random.default_rng(0)
    a, b = random.normal(size=(2, 200_000, 3))
    a, b = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (a, b))
    assert alignment(a, b).mean() == pytest.approx(0.5, abs=0.005)
    assert elementwise_alignment(a, b).mean() == pytest.approx(0.75, abs=0.005)
    assert (elementwise_alignment(a, b) >= alignment(a, b) - 1e-12).all()


def test_face_normal_of_a_face_without_area_is_zero():
    assert not face_normals(Mesh(np.eye(3), np.array([[0, 1, 1]]))).any()


def test_same_seed_same_figures():
    small = Exact(samples=2000)
    assert small.evaluate(SPHERE, BOX, 3) == small.evaluate(SPHERE, BOX, 3)
    assert small.evaluate(SPHERE, BOX, 3) != small.evaluate(SPHERE, BOX, 4)


def test_f1_of_nothing_is_zero():
    assert f1(np.ones(3), np.ones(3), 0.5) == 0
    assert f1(np.array([0.0, 1.0]), np.zeros(2), 0.5) == pytest.approx(2 / 3)


def test_rows_are_scaled_and_the_protocol_is_named():
    found = Exact(samples=1000).evaluate(similar(SPHERE, 1.01), SPHERE)
    rows = {row.name: row for row in found.rows()}
    assert rows["chamfer"].value == pytest.approx(1e3 * found.chamfer)
    assert rows["f1_005"].unit == "%"
    assert found.as_dict()["protocol"] == "exact-1"
    assert set(rows) | {"protocol"} == set(found.as_dict())


@pytest.mark.parametrize("protocol", PROTOCOLS.values())
def test_no_surface_is_an_error(protocol):
    flat = Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    none = Mesh(np.eye(3), np.empty((0, 3), dtype=np.int64))
    for bad in (flat, none):
        with pytest.raises(InputError):
            protocol.evaluate(bad, BOX)
        with pytest.raises(InputError):
            protocol.evaluate(BOX, bad)


@pytest.mark.slow
@pytest.mark.skipif(not (ABC25 / "index.csv").is_file(), reason="abc25 is not on this machine")
@pytest.mark.parametrize("name", ["abc_00000068", "abc_00010039", "abc_00679169"])
def test_ceiling_agrees_with_the_recorded_one(name: str):
    """`self_nc_elementwise` is this protocol's NC; `self_nc` is |a · b| (the two differ by up to 1.6)."""
    with (ABC25 / "index.csv").open() as stream:
        row = next(row for row in csv.DictReader(stream) if row["id"] == name)
    found = PUBLISHED.ceiling(as_mesh(trimesh.load_mesh(ABC25 / row["file"])))
    assert 100 * found.normal_consistency == pytest.approx(float(row["self_nc_elementwise"]), abs=0.2)
    assert 1000 * found.chamfer == pytest.approx(float(row["self_cd_e3"]), abs=0.02)
    assert 100 * found.f1 == pytest.approx(float(row["self_f1"]), abs=0.5)

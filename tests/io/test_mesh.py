"""Meshes come back where they were, closed and precise; a failed write leaves what was there before."""

import struct
import sys
import zipfile
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.errors import InputError, MissingExtraError, OutputError
from weingarten.io.mesh import MESH_READERS, MESH_WRITERS, check_mesh_path, read_mesh, write_mesh
from weingarten.mesh import Mesh

FRAMES = [(1.0, 0.0), (1.0, 1e6), (1e-5, 0.0), (1e-5, 1.0), (1e8, 0.0), (1.0, -3e7)]
EXACT = {".ply", ".obj", ".3mf"}

CUBE_OFF = (
    "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
    "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n"
)


def ball(scale: float = 1.0, offset: float = 0.0, subdivisions: int = 2) -> Mesh:
    sphere = trimesh.creation.icosphere(subdivisions)
    vertices = np.array(sphere.vertices) * scale + offset * np.array([1.0, -0.7, 0.3])
    return Mesh(vertices, np.array(sphere.faces, dtype=np.int64))


def is_watertight(mesh: Mesh) -> bool:
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).is_watertight


def failure(path: Path) -> str:
    """The message of the InputError that reading `path` raises: one line, naming the file."""
    with pytest.raises(InputError) as caught:
        read_mesh(path)
    message = str(caught.value)
    assert path.name in message
    assert "\n" not in message
    return message


@pytest.mark.parametrize(("scale", "offset"), FRAMES)
@pytest.mark.parametrize("suffix", MESH_WRITERS)
def test_round_trip(tmp_path, suffix, scale, offset):
    mesh = ball(scale, offset)
    path = tmp_path / f"part{suffix}"
    notes = write_mesh(path, mesh)
    back = read_mesh(path)
    assert back.vertices.dtype == np.float64
    assert back.faces.dtype == np.int64
    assert is_watertight(back)
    assert len(back.vertices) == len(mesh.vertices)
    exact = suffix in EXACT or (suffix == ".stl" and notes)
    # GLB: single precision about the centre, then one rounding in double at the offset
    tolerance = 0.0 if exact else 1e-7 * scale + 1e-15 * abs(offset)
    np.testing.assert_allclose(back.corners, mesh.corners, rtol=0, atol=tolerance)
    if suffix in EXACT:
        np.testing.assert_array_equal(back.vertices, mesh.vertices)
        np.testing.assert_array_equal(back.faces, mesh.faces)


def test_confidence_stays_with_its_vertices_in_a_ply(tmp_path):
    plain = ball(2.5, 100.0)
    scored = Mesh(plain.vertices, plain.faces, np.linspace(0.0, 1.0, len(plain.vertices)))
    write_mesh(tmp_path / "part.ply", scored)
    loaded = trimesh.load(tmp_path / "part.ply", process=False)
    found = loaded.metadata["_ply_raw"]["vertex"]["data"]["confidence"].reshape(-1)
    np.testing.assert_array_equal(found, scored.confidence.astype(np.float32))
    back = read_mesh(tmp_path / "part.ply")
    np.testing.assert_array_equal(back.vertices, plain.vertices)
    np.testing.assert_array_equal(back.faces, plain.faces)


@given(
    centre=st.floats(-1e9, 1e9, allow_subnormal=False),
    exponent=st.integers(-20, 20),
    seed=st.integers(0, 99),
)
@settings(max_examples=40, deadline=None)
@pytest.mark.parametrize("suffix", [".ply", ".obj", ".stl"])
def test_any_frame_stays_closed(tmp_path_factory, suffix, centre, exponent, seed):
    unit = ball(subdivisions=0)
    jitter = np.random.default_rng(seed).normal(scale=0.05, size=unit.vertices.shape)
    mesh = Mesh((unit.vertices + jitter) * 10.0**exponent + centre, unit.faces)
    if len(np.unique(mesh.vertices, axis=0)) < len(mesh.vertices):
        return
    path = tmp_path_factory.getbasetemp() / f"any{suffix}"
    notes = MESH_WRITERS[suffix](path, mesh)
    back = read_mesh(path)
    assert is_watertight(back)
    if suffix != ".stl" or notes:
        np.testing.assert_array_equal(back.corners, mesh.corners)


def test_only_what_the_user_must_know_is_noted(tmp_path):
    for suffix in (".stl", ".ply", ".obj", ".glb"):
        assert write_mesh(tmp_path / f"part{suffix}", ball()) == ()
    (unit,) = write_mesh(tmp_path / "part.3mf", ball())
    assert "assumed millimetre" in unit
    (precision,) = write_mesh(tmp_path / "part.stl", ball(1.0, 1e6))
    assert precision.startswith("part.stl: written as text")
    assert (tmp_path / "part.stl").read_bytes().startswith(b"solid")


def test_stl_that_would_merge_vertices_is_text(tmp_path):
    mesh = ball()
    a, b, _ = mesh.faces[0]
    close = mesh.vertices.copy()
    close[b] = np.nextafter(close[a], 2.0)
    (note,) = write_mesh(tmp_path / "part.stl", Mesh(close, mesh.faces))
    assert "merge" in note
    assert is_watertight(read_mesh(tmp_path / "part.stl"))


def test_stl_normals_point_outward(tmp_path):
    write_mesh(tmp_path / "part.stl", ball(1e-5))
    rows = np.frombuffer((tmp_path / "part.stl").read_bytes()[84:], dtype="<f4,<f4,<f4,9<f4,<u2")
    normals = np.stack([rows["f0"], rows["f1"], rows["f2"]], axis=1)
    centroids = rows["f3"].reshape(-1, 3, 3).mean(axis=1)
    assert ((normals * centroids).sum(axis=1) / np.linalg.norm(centroids, axis=1)).min() > 0.99


def test_3mf_states_millimetres(tmp_path):
    write_mesh(tmp_path / "part.3mf", ball())
    with zipfile.ZipFile(tmp_path / "part.3mf") as archive:
        assert b'unit="millimeter"' in archive.read("3D/3dmodel.model")


def test_off_with_quads(tmp_path):
    (tmp_path / "cube.off").write_text(CUBE_OFF)
    mesh = read_mesh(tmp_path / "cube.off")
    assert mesh.faces.shape == (12, 3)
    assert is_watertight(mesh)
    assert trimesh.Trimesh(mesh.vertices, mesh.faces).volume == pytest.approx(1.0)


def test_shaded_obj_is_closed(tmp_path):
    """A cube whose corners have a texture coordinate per face: trimesh splits them, reading joins them."""
    box = trimesh.creation.box()
    lines = [f"v {x} {y} {z}" for x, y, z in box.vertices] + [f"vt {i} 0" for i in range(36)]
    lines += [
        f"f {a + 1}/{3 * i + 1} {b + 1}/{3 * i + 2} {c + 1}/{3 * i + 3}"
        for i, (a, b, c) in enumerate(box.faces)
    ]
    (tmp_path / "box.obj").write_text("mtllib missing.mtl\n" + "\n".join(lines))
    mesh = read_mesh(tmp_path / "box.obj")
    assert len(mesh.vertices) == 8
    assert is_watertight(mesh)


def test_vertices_of_two_closed_bodies_that_touch_stay_apart(tmp_path):
    one = ball()
    touching = Mesh(
        np.concatenate([one.vertices, one.vertices * [-1, 1, 1] + [2 * one.vertices[:, 0].max(), 0, 0]]),
        np.concatenate([one.faces, one.faces[:, ::-1] + len(one.vertices)]),
    )
    write_mesh(tmp_path / "two.ply", touching)
    np.testing.assert_array_equal(read_mesh(tmp_path / "two.ply").vertices, touching.vertices)


def test_files_without_faces(tmp_path):
    trimesh.PointCloud(np.eye(3)).export(tmp_path / "cloud.ply")
    (tmp_path / "cloud.obj").write_text("v 0 0 0\nv 1 0 0\n")
    (tmp_path / "cloud.off").write_text("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n")
    for name in ("cloud.ply", "cloud.obj", "cloud.off"):
        assert "no faces" in failure(tmp_path / name)


def test_bad_files(tmp_path):
    assert "does not exist" in failure(tmp_path / "nowhere.stl")
    (tmp_path / "folder.ply").mkdir()
    assert "folder" in failure(tmp_path / "folder.ply")
    (tmp_path / "part.step").write_bytes(b"ISO-10303-21;")
    assert all(suffix in failure(tmp_path / "part.step") for suffix in MESH_READERS)
    random = np.random.default_rng(0).bytes(3000)
    for suffix in MESH_READERS:
        for content in (b"", b"words and words\nand words\n", random):
            (tmp_path / f"bad{suffix}").write_bytes(content)
            failure(tmp_path / f"bad{suffix}")


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".glb", ".3mf"])
def test_truncated(tmp_path, suffix):
    path = tmp_path / f"part{suffix}"
    write_mesh(path, ball())
    path.write_bytes(path.read_bytes()[:-60])
    failure(path)


def test_promised_four_billion(tmp_path):
    write_mesh(tmp_path / "part.ply", ball())
    content = (tmp_path / "part.ply").read_bytes()
    (tmp_path / "part.ply").write_bytes(content.replace(b"vertex 162", b"vertex 4000000000"))
    failure(tmp_path / "part.ply")
    (tmp_path / "part.stl").write_bytes(bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(500))
    failure(tmp_path / "part.stl")


def test_3mf_bomb(tmp_path):
    with zipfile.ZipFile(tmp_path / "part.3mf", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", b" " * 80_000_000)
    assert "unpack" in failure(tmp_path / "part.3mf")


def test_face_out_of_range_and_vertex_not_finite(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    failure(tmp_path / "a.obj")
    (tmp_path / "b.obj").write_text("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n")
    failure(tmp_path / "b.obj")


@pytest.mark.parametrize("module", ["lxml", "networkx"])
def test_3mf_without_its_extra(tmp_path, monkeypatch, module):
    monkeypatch.setitem(sys.modules, module, None)
    path = tmp_path / "part.3mf"
    check_mesh_path(path)
    write_mesh(path, ball())
    with pytest.raises(MissingExtraError, match=r'pip install "weingarten\[3mf\]"'):
        read_mesh(path)


def test_paths_are_checked_before_long_work(tmp_path):
    for suffix in MESH_WRITERS:
        check_mesh_path(tmp_path / f"part{suffix.upper()}")
    with pytest.raises(OutputError, match=r"\.3mf \.glb \.obj \.ply \.stl"):
        check_mesh_path(tmp_path / "part.step")
    with pytest.raises(OutputError, match="does not exist"):
        check_mesh_path(tmp_path / "nowhere" / "part.stl")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(OutputError, match="folder"):
        check_mesh_path(tmp_path / "folder.stl")


def test_what_cannot_be_written(tmp_path):
    mesh = ball()
    broken = mesh.vertices.copy()
    broken[3, 1] = np.nan
    for bad in (Mesh(mesh.vertices, mesh.faces[:0]), Mesh(broken, mesh.faces)):
        with pytest.raises(OutputError, match=r"part\.ply"):
            write_mesh(tmp_path / "part.ply", bad)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(28, "No space left on device")])
@pytest.mark.parametrize("suffix", MESH_WRITERS)
def test_interrupted_write_leaves_the_earlier_file(tmp_path, monkeypatch, suffix, error):
    path = tmp_path / f"part{suffix}"
    write_mesh(path, ball())
    earlier = path.read_bytes()
    write = MESH_WRITERS[suffix]

    def interrupted(target: Path, mesh: Mesh) -> tuple[str, ...]:
        write(target, mesh)
        raise error

    monkeypatch.setitem(MESH_WRITERS, suffix, interrupted)
    with pytest.raises((KeyboardInterrupt, OutputError)):
        write_mesh(path, ball(2.0))
    assert path.read_bytes() == earlier
    assert list(tmp_path.iterdir()) == [path]


@cache
def valid_content(suffix: str) -> bytes:
    """A small valid file: written once, since every whole write waits for the disk."""
    if suffix == ".off":
        return CUBE_OFF.encode()
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"part{suffix}"
        write_mesh(path, ball(subdivisions=0))
        return path.read_bytes()


edits = st.lists(st.tuples(st.integers(0, 5000), st.integers(0, 6), st.binary(max_size=6)), max_size=6)


@pytest.mark.parametrize("suffix", MESH_READERS)
@given(edits=edits, cut=st.sampled_from([0, 0, 0, 1, 7, 100]))
@settings(max_examples=200, deadline=None)
def test_mutated_files_read_or_raise_input_error(tmp_path_factory, suffix, edits, cut):
    path = tmp_path_factory.getbasetemp() / f"mutated{suffix}"
    content = valid_content(suffix)
    for at, length, new in edits:
        at %= max(len(content), 1)
        content = content[:at] + new + content[at + length :]
    path.write_bytes(content[: max(1, len(content) - cut)])
    try:
        mesh = read_mesh(path)
    except InputError:
        return
    assert mesh.faces.max() < len(mesh.vertices)

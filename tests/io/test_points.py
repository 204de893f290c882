"""Every point format gives back what was written; every bad file gives one clear InputError."""

import io
import pickle
import struct
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

sys.path.insert(0, str(Path(__file__).parent))
from files import (
    ORDERS,
    PCD_ENCODINGS,
    lzf_encoded,
    npy_bytes,
    npz_bytes,
    pcd_bytes,
    ply_bytes,
    stl_bytes,
    text_bytes,
    valid_files,
)

from weingarten.errors import InputError
from weingarten.io.lzf import lzf_decoded
from weingarten.io.points import POINT_READERS, read_points

FRAMES = [(1.0, 0.0), (1.0, 1e6), (1e-5, 0.0), (1e-5, 1e6)]

finite_points = arrays(
    np.float64,
    st.tuples(st.integers(1, 20), st.just(3)),
    elements=st.floats(allow_nan=False, allow_infinity=False),
)


@pytest.fixture
def cloud() -> np.ndarray:
    return np.random.default_rng(0).uniform(-1, 1, (50, 3))


LABELS = list(valid_files(np.zeros((3, 3))))


def made(folder: Path, name: str, content: bytes) -> Path:
    path = folder / name
    path.write_bytes(content)
    return path


def failure(path: Path) -> str:
    """The message of the InputError that reading `path` raises: one sentence on one line, naming the file."""
    with pytest.raises(InputError) as caught:
        read_points(path)
    message = str(caught.value)
    assert path.name in message
    assert "\n" not in message
    assert message.endswith(".")
    return message


@pytest.mark.parametrize(("scale", "offset"), FRAMES)
@pytest.mark.parametrize("label", LABELS)
def test_round_trip(tmp_path, cloud, label, scale, offset):
    points = cloud[:48] * scale + offset
    if label == "stl binary":
        points = points.astype(np.float32).astype(np.float64)
        points = points[np.sort(np.unique(points, axis=0, return_index=True)[1])]
        points = points[: len(points) // 3 * 3] if len(points) >= 3 else np.eye(3)
    read = read_points(made(tmp_path, *valid_files(points)[label]))
    assert read.dtype == np.float64
    np.testing.assert_array_equal(read, points)


def test_every_extension_is_tried():
    assert {Path(name).suffix for name, _ in valid_files(np.zeros((3, 3))).values()} == set(POINT_READERS)


@pytest.mark.parametrize("encoding", ORDERS)
@pytest.mark.parametrize("before", ["", "even", "odd"])
@given(points=finite_points)
@settings(max_examples=25, deadline=None)
def test_ply_any_doubles(tmp_path_factory, encoding, before, points):
    path = made(tmp_path_factory.getbasetemp(), "any.ply", ply_bytes(points, encoding, before=before))
    np.testing.assert_array_equal(read_points(path), points)


@pytest.mark.parametrize("encoding", PCD_ENCODINGS)
@given(points=finite_points)
@settings(max_examples=25, deadline=None)
def test_pcd_any_doubles(tmp_path_factory, encoding, points):
    path = made(tmp_path_factory.getbasetemp(), "any.pcd", pcd_bytes(points, encoding))
    np.testing.assert_array_equal(read_points(path), points)


@pytest.mark.parametrize("encoding", ORDERS)
@pytest.mark.parametrize("kind", ["float", "int", "uchar"])
def test_ply_other_types(tmp_path, encoding, kind):
    points = np.arange(30.0).reshape(10, 3) + (0.1 if kind == "float" else 0.0)
    read = read_points(made(tmp_path, "a.PLY", ply_bytes(points, encoding, kind)))
    np.testing.assert_array_equal(read, points.astype(np.float32))


@pytest.mark.parametrize("newline", [b"\r\n", b"\r"])
@pytest.mark.parametrize("encoding", ORDERS)
def test_ply_other_line_ends(tmp_path, cloud, encoding, newline):
    content = ply_bytes(cloud, encoding)
    if encoding == "ascii":
        content = content.replace(b"\n", newline)
    else:
        head, mark, body = content.partition(b"end_header\n")
        content = (head + mark).replace(b"\n", newline) + body
    np.testing.assert_array_equal(read_points(made(tmp_path, "a.ply", content)), cloud)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("even", [True, False])
def test_ply_list_within_vertices(tmp_path, cloud, order, even):
    encoding = "binary_little_endian" if order == "<" else "binary_big_endian"
    axes = "".join(f"property double {axis}\n" for axis in "xyz")
    header = f"ply\nformat {encoding} 1.0\nelement vertex {len(cloud)}\nproperty list short float w\n{axes}"
    rows = []
    for i, row in enumerate(cloud.tolist()):
        weights = [0.5] * (2 if even else i % 4)
        rows.append(struct.pack(f"{order}h{len(weights)}f3d", len(weights), *weights, *row))
    content = f"{header}end_header\n".encode() + b"".join(rows)
    np.testing.assert_array_equal(read_points(made(tmp_path, "a.ply", content)), cloud)


def test_pcd_float32_and_width_times_height(tmp_path, cloud):
    content = pcd_bytes(cloud, "binary", size=4).replace(b"POINTS 50\n", b"")
    content = content.replace(b"WIDTH 50\nHEIGHT 1", b"WIDTH 10\nHEIGHT 5")
    np.testing.assert_array_equal(read_points(made(tmp_path, "a.pcd", content)), cloud.astype(np.float32))


@given(st.lists(st.sampled_from([b"a", b"bc", b"\0" * 9, bytes(range(40))]), max_size=60).map(b"".join))
@settings(max_examples=50, deadline=None)
def test_lzf(data):
    assert lzf_decoded(lzf_encoded(data), len(data)) == data


@pytest.mark.parametrize(
    ("name", "before", "delimiter"),
    [
        ("a.xyz", "", " "),
        ("a.xyz", "50\n", " "),
        ("a.xyz", "\n# comment\n  \n", "   "),
        ("a.txt", "X Y Z\n", "\t"),
        ("a.txt", "//X,Y,Z\n", ", "),
        ("a.csv", '# made by a scanner\n"x","y","z"\n', ","),
        ("a.csv", "\ufeff", ";"),
    ],
)
def test_text_dialects(tmp_path, cloud, name, before, delimiter):
    path = made(tmp_path, name, text_bytes(cloud, delimiter, before))
    np.testing.assert_array_equal(read_points(path), cloud)


def test_text_further_columns_and_comments(tmp_path):
    path = made(tmp_path, "a.xyz", b"1 2 3 0.5 a\n4 5 6 0.5 b # end\n\n7 8 9\n")
    np.testing.assert_array_equal(read_points(path), np.arange(1.0, 10.0).reshape(3, 3))


def test_text_named_columns(tmp_path):
    path = made(tmp_path, "a.csv", b"id,z,y,x\n0,3,2,1\n1,6,5,4\n")
    np.testing.assert_array_equal(read_points(path), [[1, 2, 3], [4, 5, 6]])


def test_text_decimal_comma(tmp_path):
    path = made(tmp_path, "a.csv", b"x;y;z\n1,5;2,25;-3\n4;5,5;6e-3\n")
    np.testing.assert_array_equal(read_points(path), [[1.5, 2.25, -3], [4, 5.5, 6e-3]])


def test_rows_that_are_not_finite_are_kept(tmp_path):
    read = read_points(made(tmp_path, "a.xyz", b"1 2 3\nnan inf -inf\n"))
    np.testing.assert_array_equal(read, [[1, 2, 3], [np.nan, np.inf, -np.inf]])


def test_stl_corners_come_once_in_order(tmp_path):
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float)
    expected = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    for text in (True, False):
        np.testing.assert_array_equal(
            read_points(made(tmp_path, "a.stl", stl_bytes(corners, text))), expected
        )


def test_npz_the_only_fitting_array(tmp_path, cloud):
    path = made(tmp_path, "a.npz", npz_bytes(scan=cloud, labels=np.arange(50)))
    np.testing.assert_array_equal(read_points(path), cloud)
    message = failure(made(tmp_path, "b.npz", npz_bytes(one=cloud, two=cloud)))
    assert "one, two" in message


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.int16, np.uint8])
def test_npy_other_types(tmp_path, dtype):
    array = np.arange(40).reshape(10, 4).astype(dtype)
    np.testing.assert_array_equal(read_points(made(tmp_path, "a.npy", npy_bytes(array))), array[:, :3])


def test_missing_folder_empty_unknown(tmp_path):
    assert "does not exist" in failure(tmp_path / "nowhere.ply")
    folder = tmp_path / "folder.ply"
    folder.mkdir()
    assert "folder" in failure(folder)
    for suffix in POINT_READERS:
        assert "empty" in failure(made(tmp_path, f"empty{suffix}", b""))
    message = failure(made(tmp_path, "part.step", b"ISO-10303-21;"))
    assert all(suffix in message for suffix in POINT_READERS)


@pytest.mark.parametrize("label", [label for label in LABELS if label not in {"xyz", "txt", "csv", "obj"}])
def test_truncated(tmp_path, cloud, label):
    name, content = valid_files(cloud)[label]
    for length in (1, 10, len(content) // 2, len(content) - 40):
        failure(made(tmp_path, name, content[:length]))


@pytest.mark.parametrize("encoding", ORDERS)
def test_ply_promises_four_billion(tmp_path, cloud, encoding):
    for before in ("", "even", "odd"):
        content = ply_bytes(cloud, encoding, before=before)
        for element in (b"vertex 50", b"face 3"):
            huge = content.replace(b"element " + element, b"element " + element.split()[0] + b" 4000000000")
            if huge != content:
                assert "promises" in failure(made(tmp_path, "a.ply", huge))


@pytest.mark.parametrize("encoding", PCD_ENCODINGS)
def test_pcd_promises_four_billion(tmp_path, cloud, encoding):
    content = pcd_bytes(cloud, encoding).replace(b"POINTS 50", b"POINTS 4000000000")
    failure(made(tmp_path, "a.pcd", content))


def test_stl_promises_four_billion(tmp_path, cloud):
    content = stl_bytes(cloud[:48].reshape(-1, 3, 3), text=False)
    content = b"binary".ljust(80) + struct.pack("<I", 4_000_000_000) + content[84:]
    assert "promises 4000000000" in failure(made(tmp_path, "a.stl", content))


def test_npy_promises_a_terabyte(tmp_path, cloud):
    content = npy_bytes(cloud).replace(b"(50, 3), }" + b" " * 10, b"(50000000000, 3), }"[:19] + b" ")
    assert b"50000000000" in content
    failure(made(tmp_path, "a.npy", content))
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("points.npy", content)
    assert "promises" in failure(made(tmp_path, "a.npz", stream.getvalue()))


def test_npz_bomb(tmp_path):
    stream = io.BytesIO()
    with (
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("points.npy", "w") as raw,
    ):
        np.lib.format.write_array_header_1_0(
            raw, {"descr": "<f8", "fortran_order": False, "shape": (3_000_000, 3)}
        )
        raw.write(bytes(72_000_000))
    assert "unpack" in failure(made(tmp_path, "a.npz", stream.getvalue()))


class Trap:
    """Unpickling this would leave a trace."""

    def __reduce__(self):
        return Path.touch, (Path("trap-sprung"),)


def test_pickles_are_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    objects = np.array([[Trap(), 1, 2]], dtype=object)
    failure(made(tmp_path, "a.npy", npy_bytes(objects)))
    failure(made(tmp_path, "a.npz", npz_bytes(points=objects)))
    failure(made(tmp_path, "b.npy", pickle.dumps(Trap())))
    assert not (tmp_path / "trap-sprung").exists()


def test_garbage(tmp_path):
    random = np.random.default_rng(1).bytes(5000)
    words = b"lorem ipsum dolor sit amet\nconsectetur adipiscing elit sed do\n"
    for suffix in POINT_READERS:
        failure(made(tmp_path, f"random{suffix}", random))
        failure(made(tmp_path, f"words{suffix}", words))
    assert "binary" in failure(made(tmp_path, "binary.xyz", random))


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"1 2 3\n4 five 6\n", "five"),
        (b"1 2\n3 4\n", "three"),
        (b"1 2 x\n3 4 5\n", "three"),
        (b"1 2 3\n4 5\n", "2"),
        (b"# only\n", "no points"),
    ],
)
def test_text_that_is_no_table(tmp_path, content, reason):
    assert reason in failure(made(tmp_path, "a.xyz", content))


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (b"element vertex 50", b"element point 50", "vertex"),
        (b"element vertex 50", b"element vertex 0", "no points"),
        (b"element vertex 50", b"element vertex -1", "negative"),
        (b"property double z", b"property double w", "x, y and z"),
        (b"property double z", b"property quad z", "quad"),
        (b"end_header", b"", "end_header"),
        (b"ascii", b"base64", "base64"),
    ],
)
def test_ply_bad_headers(tmp_path, cloud, old, new, reason):
    content = ply_bytes(cloud, "ascii")
    assert old in content
    assert reason in failure(made(tmp_path, "a.ply", content.replace(old, new)))


def mutated(content: bytes, edits: list[tuple[int, int, bytes]], cut: int) -> bytes:
    """`content` with byte runs replaced, and its end cut off."""
    for at, length, new in edits:
        at %= len(content)
        content = content[:at] + new + content[at + length :]
        content = content or b"\n"
    return content[: max(1, len(content) - cut)]


edits = st.lists(st.tuples(st.integers(0, 5000), st.integers(0, 6), st.binary(max_size=6)), max_size=6)


@pytest.mark.parametrize("label", LABELS)
@given(edits=edits, cut=st.sampled_from([0, 0, 0, 1, 7, 100]))
@settings(max_examples=200, deadline=None)
def test_mutated_files_read_or_raise_input_error(tmp_path_factory, label, edits, cut):
    name, content = valid_files(np.random.default_rng(2).normal(size=(6, 3)))[label]
    path = made(tmp_path_factory.getbasetemp(), f"mutated-{name}", mutated(content, edits, cut))
    try:
        points = read_points(path)
    except InputError:
        pass
    else:
        assert points.dtype == np.float64
        assert points.shape == (len(points), 3)


def test_a_comment_with_bytes_that_break_lines_elsewhere_costs_no_point(tmp_path):
    path = tmp_path / "scan.xyz"
    path.write_bytes("# in Ångström\n1 2 3\n4 5 6\n7 8 9\n".encode())
    np.testing.assert_array_equal(read_points(path), [[1, 2, 3], [4, 5, 6], [7, 8, 9]])

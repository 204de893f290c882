"""Whatever a file holds, reading it ends soon, in little memory, with its content or one of our sentences."""

import json
import os
import subprocess
import sys
import zipfile
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parent))
from bad_archives import zipped
from bad_files import every_bad_file
from files import every_valid_file, read
from mutation import mutated

from weingarten.errors import InputError, WeingartenError
from weingarten.io.mesh import MESH_READERS
from weingarten.io.points import POINT_READERS
from weingarten.io.unfolding import INSTANCE, unfolded_size

VALID = every_valid_file()
OTHERS = [file.content for file in VALID.values()]
MEMORY = 100 << 20
"""Most bytes that all bad files together may add to a process; the largest of them is two megabytes."""


def test_bad_files_in_bounds(tmp_path):
    """Some thousand files in a process of their own, which may not take 300 MB more than it has."""
    program = Path(__file__).parent / "reading_in_bounds.py"
    words = [sys.executable, str(program), str(tmp_path)]
    said = subprocess.run(words, capture_output=True, text=True, timeout=300)
    assert said.returncode == 0, said.stderr
    found = json.loads(said.stdout)
    assert found["wrong"] == {}
    assert found["files"] > 2500
    assert found["grown"] < MEMORY


def test_every_reader_has_bad_files():
    tried = {(reader, Path(name).suffix) for _, reader, name, _ in every_bad_file()}
    assert tried == {("points", suffix) for suffix in POINT_READERS} | {
        ("mesh", suffix) for suffix in MESH_READERS
    }


@pytest.mark.parametrize("label", VALID)
def test_valid_files_are_read(tmp_path, label):
    path = tmp_path / VALID[label].name
    path.write_bytes(VALID[label].content)
    read(VALID[label].reader, path)


@pytest.mark.parametrize("label", VALID)
@given(seed=st.integers(0, 2**32))
@settings(max_examples=40)
def test_mutations_are_read_or_refused(tmp_path_factory, label, seed):
    file = VALID[label]
    path = tmp_path_factory.getbasetemp() / file.name
    path.write_bytes(mutated(file.name, file.content, seed, OTHERS))
    said = ""
    try:
        read(file.reader, path)
    except WeingartenError as error:
        said = str(error)
    assert "into memory" not in said
    assert "\n" not in said


@pytest.mark.parametrize("reader", ["points", "mesh"])
def test_pipes_and_devices_are_refused_at_once(tmp_path, reader):
    os.mkfifo(tmp_path / "pipe.ply")
    (tmp_path / "zero.stl").symlink_to("/dev/zero")
    (tmp_path / "null.obj").symlink_to("/dev/null")
    for name in ("pipe.ply", "zero.stl", "null.obj"):
        with pytest.raises(InputError, match="pipe or a device"):
            read(reader, tmp_path / name)


def test_links_are_what_they_point_to(tmp_path):
    (tmp_path / "a.npy").write_bytes(VALID["points npy"].content)
    (tmp_path / "link.npy").symlink_to("a.npy")
    read("points", tmp_path / "link.npy")
    (tmp_path / "loop.npy").symlink_to("loop.npy")
    (tmp_path / "none.npy").symlink_to("nowhere.npy")
    for name in ("loop.npy", "none.npy", "a" * 300 + ".npy", "nul\0.npy", "a.npy/b.npy"):
        with pytest.raises(InputError):
            read("points", tmp_path / name)


def test_no_other_file_is_opened(tmp_path):
    """A mesh that names its textures, materials and buffers is read without them."""
    opened: list[str] = []
    inside = [True]

    def hook(event: str, arguments: tuple) -> None:
        if event == "open" and inside[0]:
            opened.append(str(arguments[0]))

    sys.addaudithook(hook)
    for label, reader, name, content in every_bad_file():
        if "elsewhere" in label or "buffer " in label or "image" in label:
            path = tmp_path / name
            path.write_bytes(content)
            with suppress(WeingartenError):
                read(reader, path)
    inside[0] = False
    names = {Path(name).name for name in opened if not name.isdigit()}
    assert not names & {"zero", "passwd"}


def test_archives_are_never_unpacked_to_files(tmp_path):
    content = zipped({"../outside.npy": VALID["points npy"].content, "/tmp/outside.npy": b"x"})
    (tmp_path / "inner").mkdir()
    path = tmp_path / "inner" / "a.npz"
    path.write_bytes(content)
    with pytest.raises(InputError):
        read("points", path)
    assert sorted(one.name for one in tmp_path.rglob("*")) == ["a.npz", "inner"]


def test_a_wrong_sum_is_noticed(tmp_path):
    array = VALID["points npy"].content
    content = zipped({"points.npy": array}, zipfile.ZIP_STORED)
    at = content.index(array) + len(array) - 3
    path = tmp_path / "a.npz"
    path.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
    with pytest.raises(InputError):
        read("points", path)


def test_unfolded_size_counts_every_place():
    """Against the obvious recursion; twice as many at every level end at the limit, without unfolding."""
    own = {"a": 5, "b": 7, "c": 11}
    parts = {"a": ["b", "b", "c"], "b": ["c"]}

    def slow(key: str) -> int:
        return own[key] + INSTANCE + sum(map(slow, parts.get(key, ())))

    assert unfolded_size(own, parts, ["a", "b"]) == slow("a") + slow("b")
    doubled = {k: [k + 1, k + 1] for k in range(5000)}
    assert unfolded_size({}, doubled, [0]) >= 1 << 62
    with pytest.raises(ValueError, match="part of itself"):
        unfolded_size({}, {1: [2], 2: [3, 1]}, [1])

"""A disk that is full, or may not be written: earlier files stay, and a fit is kept and said where."""

import errno
import functools
import json
import os
import resource
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from small import small_cloud, small_settings

from weingarten import atomic
from weingarten.atomic import replacing
from weingarten.cli.main import main
from weingarten.errors import OutputError
from weingarten.fit import checkpoint
from weingarten.io import mesh as mesh_files
from weingarten.io.cloud_file import FORMATS, write_cloud
from weingarten.io.mesh import MESH_WRITERS, read_mesh, write_mesh
from weingarten.mesh import Mesh
from weingarten.observer import Observer
from weingarten.reconstruction import Result, reconstruct
from weingarten.report.picture import write_picture

SMALL = ["--steps", "4", "--points-per-step", "50", "--resolution", "8", "--sharp", "off"]
SOLID = Mesh(np.eye(4, 3), np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]]))


@contextmanager
def room(size: int) -> Iterator[None]:
    """No file may grow beyond so many bytes: the kernel refuses, as it does on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("size", [0, 40])
@pytest.mark.parametrize("name", [f"a{suffix}" for suffix in (*MESH_WRITERS, *FORMATS)] + ["a.png"])
def test_the_earlier_file_stays(tmp_path, name, size):
    path = tmp_path / name
    path.write_bytes(b"earlier")
    points = np.random.default_rng(0).normal(size=(50, 3))
    if path.suffix == ".png":
        write = functools.partial(write_picture, path, points, SOLID)
    elif path.suffix in FORMATS:
        write = functools.partial(write_cloud, path, points)
    else:
        write = functools.partial(write_mesh, path, SOLID)
    with room(size), pytest.raises(OutputError, match=name):
        write()
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]


@pytest.fixture(scope="module")
def whole() -> Result:
    """The fit where nothing happens to it."""
    return reconstruct(small_cloud(), small_settings())


@pytest.mark.parametrize("size", [0, 5000])
def test_a_full_disk_in_the_middle_of_a_fit(tmp_path, whole, size):
    """The checkpoint before stays, and the fit goes on from it to the same mesh."""

    class Filling(Observer):
        def step(self, record, steps, seconds) -> None:
            if record.step == 2:
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

    with pytest.raises(OutputError), room(1 << 40):
        reconstruct(small_cloud(), small_settings(), run_folder=tmp_path / "run", observer=Filling())
    again = reconstruct(small_cloud(), small_settings(), run_folder=tmp_path / "run", resume=True)
    np.testing.assert_array_equal(again.mesh.vertices, whole.mesh.vertices)


def full(path: Path, mesh: Mesh) -> tuple[str, ...]:
    """A writer that finds no room."""
    raise OSError(errno.ENOSPC, "No space left on device")


@pytest.fixture
def cloud(tmp_path) -> Path:
    write_cloud(tmp_path / "a.npy", small_cloud())
    return tmp_path / "a.npy"


@pytest.mark.parametrize("kept", [True, False])
def test_a_full_disk_at_the_end_of_a_fit(tmp_path, monkeypatch, capsys, cloud, whole, kept):
    """What the sentence says to do gives the mesh that could not be written."""
    out, folder = tmp_path / "part.stl", tmp_path / "part.run"
    words = ["fit", str(cloud), "-o", str(out), *SMALL, *(["--run", str(folder)] if kept else [])]
    monkeypatch.setitem(mesh_files.MESH_WRITERS, ".stl", full)
    assert main(words) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert f"No space left on device; the fit is kept in {folder}, make room and go on with: " in said
    monkeypatch.undo()
    again = said.split(": weingarten ")[1].split()
    assert again[:2] == ["fit", str(cloud)]
    assert "--resume" in again
    assert main([*again, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["summary"]["steps"] == 4
    write_mesh(tmp_path / "expected.stl", whole.mesh)
    assert out.read_bytes() == (tmp_path / "expected.stl").read_bytes()
    read_mesh(out)


def test_no_room_beside_the_output(tmp_path, monkeypatch, capsys, cloud):
    """Then the fit is kept among the temporary files; and where there is no room at all, this is said."""
    monkeypatch.setitem(mesh_files.MESH_WRITERS, ".stl", full)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "elsewhere"))
    save = checkpoint.save

    def picky(path: Path, *rest) -> None:
        if path.parent.parent == tmp_path:
            raise OutputError(f"{path} could not be written: No space left on device.")
        save(path, *rest)

    monkeypatch.setattr(checkpoint, "save", picky)
    words = ["fit", str(cloud), "-o", str(tmp_path / "part.stl"), *SMALL, "--quiet"]
    assert main(words) == 2
    assert f"kept in {tmp_path / 'elsewhere' / 'part.run'}" in capsys.readouterr().err
    assert not (tmp_path / "part.run").exists()
    monkeypatch.setattr(checkpoint, "save", lambda path, *rest: picky(tmp_path / "run" / path.name))
    assert main(words) == 2
    assert "could not be kept anywhere" in capsys.readouterr().err


def test_a_folder_that_is_there_is_not_taken_for_a_spare_one(tmp_path, monkeypatch, capsys, cloud):
    (tmp_path / "part.run").mkdir()
    (tmp_path / "part.run" / "mine").write_text("kept")
    monkeypatch.setitem(mesh_files.MESH_WRITERS, ".stl", full)
    assert main(["fit", str(cloud), "-o", str(tmp_path / "part.stl"), *SMALL, "--quiet"]) == 2
    assert f"kept in {tmp_path / 'part-2.run'}" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "part.run").iterdir()] == ["mine"]


@pytest.mark.parametrize("number", [errno.EROFS, errno.ENOSPC, errno.EACCES, errno.EDQUOT])
def test_a_file_that_cannot_be_begun(tmp_path, monkeypatch, number):
    def refused(*_: object) -> int:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(atomic.os, "open", refused)
    with pytest.raises(OutputError, match=os.strerror(number)), replacing(tmp_path / "a.txt"):
        raise AssertionError
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_may_not_be_written_is_known_before_the_fit(tmp_path, monkeypatch, cloud, capsys):
    monkeypatch.setattr(atomic.os, "access", lambda *_: False)
    assert main(["fit", str(cloud), "-o", str(tmp_path / "part.stl")]) == 2
    assert "not writable" in capsys.readouterr().err


def test_a_clock_that_jumps(tmp_path, monkeypatch, whole):
    """The time of day goes back by a year with every question; the fit does not notice."""
    now = [time.time()]

    def backwards() -> float:
        now[0] -= 365 * 86400
        return now[0]

    monkeypatch.setattr(time, "time", backwards)
    monkeypatch.setattr(time, "time_ns", lambda: int(backwards() * 1e9))
    jumped = reconstruct(small_cloud(), small_settings(), run_folder=tmp_path / "run")
    assert all(0 <= seconds < 600 for seconds in jumped.summary.seconds.values())
    np.testing.assert_array_equal(jumped.mesh.vertices, whole.mesh.vertices)


def test_nothing_asks_for_the_time_of_day():
    """But the date beside a table, the log of a fit, and the page that says for how long a fit is silent."""
    source = Path(atomic.__file__).parent
    asking = {
        path.name
        for path in source.rglob("*.py")
        if any(
            word in path.read_text(encoding="utf-8")
            for word in ("time.time", ".now(", "st_mtime", "st_ctime")
        )
    }
    assert asking == {"provenance.py", "log.py", "run.py"}

"""A job goes to a machine that sees no folder of this one, and its files come back."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from jobs_of_tests import Errand

from weingarten.many.parcel import Parcel, unpack
from weingarten.many.workers import perform


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "given" / "cloud.bin"
    path.parent.mkdir()
    path.write_bytes(b"\0\1\2")
    return path


def test_a_job_is_done_elsewhere_and_its_files_are_written_here(tmp_path: Path, source: Path):
    job = Errand(tmp_path / "out", "one", source)
    parcel = Parcel.of([job])
    source.unlink()
    files = parcel.done(perform)
    assert set(files) == {"one/copy.bin", "one/calls", "one/fit.json"}
    assert not job.folder.exists(), "nothing was done here"
    unpack(files, job.root)
    unpack(files, job.root)
    assert (job.folder / "copy.bin").read_bytes() == b"\0\1\2"
    assert job.record["status"] == "done"
    assert not list(tmp_path.rglob(".*"))


def test_what_was_kept_goes_along(tmp_path: Path, source: Path):
    job = Errand(tmp_path / "out", "one", source)
    job.make()
    unpack(Parcel.of([job]).done(perform), job.root)
    assert len((job.folder / "calls").read_text().split()) == 2


def test_sentences_name_the_files_of_this_machine(tmp_path: Path, source: Path):
    job = Errand(tmp_path / "out", "fail", source)
    unpack(Parcel.of([job]).done(perform), job.root)
    assert job.error == f"{source} is too hard."


def test_that_it_is_done_is_said_last(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    written: list[str] = []
    replace = Path.replace
    monkeypatch.setattr(Path, "replace", lambda self, to: (written.append(to.name), replace(self, to))[1])
    unpack({"a/fit.json": b"{}", "a/mesh.ply": b"ply", "a/zebra": b""}, tmp_path)
    assert written == ["mesh.ply", "zebra", "fit.json"]

"""The page about one fit as text: whole, escaped, the same every time, and of folders that lack something."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))
import one_run
from checking import checked
from one_run import EVIL

from weingarten.errors import InputError, MissingExtraError, OutputError
from weingarten.mesh import Mesh
from weingarten.report.kinds import kind_of
from weingarten.report.run import pictures
from weingarten.report.run.page import write_run_page
from weingarten.samples.parts import part_mesh


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return one_run.make(tmp_path_factory.mktemp("runs") / "part")


@pytest.fixture(scope="module")
def text(folder: Path) -> str:
    made = write_run_page(folder, folder / "report.html")
    written = (folder / "report.html").read_text(encoding="utf-8")
    assert made.size == len(written.encode())
    return written


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small pictures, where they do not matter."""
    monkeypatch.setattr(pictures, "WIDE", 120)
    monkeypatch.setattr(pictures, "NARROW", 90)


def test_it_is_whole_html_and_needs_nothing_else(text: str):
    found = checked(text)
    assert not found.open
    assert len(found.ids) == len(set(found.ids))
    for address in found.addresses:
        assert address.startswith(("data:", "#")), address
        assert address == "data:," or not address.startswith("#") or address[1:] in found.ids
    assert not re.search(r"https?:|//cdn|@import|url\((?!#)", text)


def test_hostile_notes_and_paths_are_escaped(text: str):
    assert EVIL not in text
    assert "<script>document" not in text
    assert text.count("&lt;script&gt;document.title") >= 4
    shown = json.loads(re.search(r'id="viewing">(.*?)</script>', text)[1])
    assert "broken in" in shown["parts"][0]["name"]


def test_everything_that_was_promised_is_there(text: str):
    for said in (
        "Watertight, one piece, no through-hole (genus 0); 95 % of the points lie within 0.15 of the mesh",
        "0.5 % of the points lie beyond the ends",
        "<dt>mean, with sign</dt><dd>+0.0175 <small>u</small>",
        "<dt>std. deviation</dt><dd>0.117 <small>u</small>",
        "<dt>95 % within</dt><dd>0.15 <small>u</small>",
        "<dt>worst point</dt><dd>+0.5 <small>u</small>",
        "off-diagonal Weingarten",
        "preset: 800",
        "0.1.0 (0123abc)",
        "A machine, 2 cores",
        "To make it again",
        "1,000 <small>u³</small>",
    ):
        assert said in text, said
    assert text.count('class="shot"') == 1 + 4
    assert text.count('class="plot"') == 2 + 3
    assert "Primitives" not in text


def test_the_same_folder_gives_the_same_bytes(folder: Path, text: str, tmp_path: Path):
    write_run_page(folder, tmp_path / "again.html")
    assert (tmp_path / "again.html").read_text(encoding="utf-8") == text


@pytest.mark.usefixtures("small")
def test_a_run_without_mesh_shows_its_points_and_losses(tmp_path: Path):
    folder = one_run.without_mesh(tmp_path / "part")
    made = write_run_page(folder, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert made.steps == 20
    assert "This run has no mesh: it ended after step 20 of 60" in text
    assert not checked(text).open
    assert text.count("<img ") == 1
    assert 'id="viewer"' not in text
    assert 'id="curves"' in text


@pytest.mark.usefixtures("small")
def test_an_open_mesh_and_one_that_is_far_from_its_points(tmp_path: Path):
    whole = one_run.box()
    folder = one_run.make(tmp_path / "part", Mesh(whole.vertices + 3.0, whole.faces[:-1]))
    write_run_page(folder, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "Not watertight" in text
    assert "distances have no sign" in text
    assert "mean, with sign" not in text


@pytest.mark.usefixtures("small")
def test_primitives_and_what_an_earlier_version_did_not_keep(tmp_path: Path):
    folder = one_run.make(tmp_path / "part")
    row = {"kind": "plane", "note": EVIL}
    (folder / "primitives.json").write_text(json.dumps({"primitives": [row, "no row"], "more": 1}))
    (folder / "made.json").unlink()
    (folder / "loss.csv").unlink()
    (folder / "summary.json").write_text("{}")
    write_run_page(folder, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert '<th scope="row">plane</th>' in text
    assert EVIL not in text
    assert "The folder does not say" in text
    assert 'id="curves"' not in text


@pytest.mark.parametrize(
    "name", ["config.toml", "cloud.npy", "summary.json", "made.json", "primitives.json", "mesh.ply"]
)
def test_broken_files_end_in_one_sentence(name: str, tmp_path: Path):
    folder = one_run.make(tmp_path / "part")
    (folder / name).write_text("broken")
    with pytest.raises(InputError, match=name):
        write_run_page(folder, tmp_path / "page.html")
    assert not (tmp_path / "page.html").exists()


def test_a_cloud_of_another_shape_is_no_cloud(tmp_path: Path):
    folder = one_run.make(tmp_path / "part")
    np.save(folder / "cloud.npy", np.zeros((4, 2)))
    with pytest.raises(InputError, match="its array is float64"):
        write_run_page(folder, tmp_path / "page.html")


def test_places_and_extras(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(OutputError, match="does not exist; create it first"):
        write_run_page(folder, tmp_path / "none" / "page.html")
    monkeypatch.setitem(sys.modules, "jinja2", None)
    with pytest.raises(MissingExtraError, match="jinja2"):
        write_run_page(folder, tmp_path / "page.html")


def test_folders_are_told_by_what_is_in_them(folder: Path, tmp_path: Path):
    assert kind_of(folder).name == "a run"
    (tmp_path / "fits").mkdir()
    assert kind_of(tmp_path).name == "a benchmark"


def test_the_page_of_a_real_part_stays_small(tmp_path: Path):
    """A third of the 3 MB that it may have: of a rough mesh of very many triangles, under noisy points."""
    mesh = part_mesh("flange", 64)
    rough = mesh.vertices + np.random.default_rng(0).normal(0, 0.05, mesh.vertices.shape)
    folder = one_run.make(tmp_path / "part", Mesh(rough, mesh.faces))
    np.save(folder / "cloud.npy", rough + np.random.default_rng(1).normal(0, 0.1, rough.shape))
    assert write_run_page(folder, tmp_path / "page.html").size < 1_000_000

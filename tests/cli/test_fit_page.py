"""`weingarten fit --page`: the page of a fit that keeps no folder, and mistakes told before it."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from command import run

from weingarten.cli.main import main
from weingarten.io.cloud_file import write_cloud
from weingarten.samples.parts import sample_part


@pytest.fixture(scope="module")
def cloud(tmp_path_factory) -> Path:
    """A small scan of a bundled part, by a name with a blank in it."""
    path = tmp_path_factory.mktemp("cloud") / "a flange.ply"
    write_cloud(path, sample_part("flange", 4000, 0))
    return path


@pytest.fixture(scope="module")
def fitted(cloud: Path, tmp_path_factory) -> Path:
    """A folder with a page, of a fit that kept nothing else but its mesh."""
    folder = tmp_path_factory.mktemp("fitted")
    words = ["-o", folder / "part.stl", "--page", folder / "page.html", "--quiet", "--steps", 20]
    code, _, err = run("fit", cloud, *words, "--points-per-step", 100, "--resolution", 24)
    assert (code, err) == (0, "")
    return folder


def test_a_page_comes_with_a_fit_and_nothing_is_left_beside_it(fitted: Path):
    assert sorted(path.name for path in fitted.iterdir()) == ["page.html", "part.stl"]
    text = (fitted / "page.html").read_text(encoding="utf-8")
    assert "<h1>a flange.ply</h1>" in text
    assert 'id="curves"' in text
    assert "--steps 20" in text


@pytest.mark.parametrize(
    ("page", "said"),
    [
        ("page.pdf", "end its name in .html"),
        ("none/page.html", "does not exist; create it first"),
        ("folder.html", "is a folder; give a file name"),
    ],
)
def test_a_place_that_is_none_is_said_before_the_fit(
    page: str, said: str, cloud: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
):
    (tmp_path / "folder.html").mkdir()
    never_fitted(monkeypatch)
    words = ["fit", str(cloud), "-o", str(tmp_path / "part.stl"), "--page", str(tmp_path / page)]
    assert main(words) == 2
    err = capsys.readouterr().err
    assert said in err
    assert len(err.splitlines()) == 1


def test_a_missing_extra_is_said_before_the_fit(
    cloud: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
):
    never_fitted(monkeypatch)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    words = ["fit", str(cloud), "-o", str(tmp_path / "part.stl"), "--page", str(tmp_path / "page.html")]
    assert main(words) == 2
    assert 'pip install "weingarten[report]"' in capsys.readouterr().err


def never_fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    """From here on a fit that begins is an error."""

    def begun(*words: object, **options: object) -> None:
        raise AssertionError("The fit has begun.")

    monkeypatch.setattr("weingarten.reconstruction.reconstruct", begun)

"""Figures as files: both formats, the same bytes every time, no setting touched, the extra named."""

import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib
import pytest
from PIL import Image

from weingarten.errors import MissingExtraError, OutputError
from weingarten.reproduce import style
from weingarten.reproduce.figure_regimes import figure_regimes
from weingarten.reproduce.figure_schedules import figure_schedules
from weingarten.reproduce.save import write_figure

MAKERS: dict[str, Callable] = {"regimes": lambda: figure_regimes(panel=40), "schedules": figure_schedules}


@pytest.mark.parametrize("name", MAKERS)
def test_the_same_figure_is_the_same_bytes(tmp_path: Path, name: str):
    first = write_figure(MAKERS[name](), tmp_path / "figure 1.2")
    assert [path.name for path in first] == ["figure 1.2.png", "figure 1.2.svg"]
    assert sorted(path.name for path in tmp_path.iterdir()) == [path.name for path in first]
    before = [path.read_bytes() for path in first]
    with matplotlib.rc_context({"font.size": 23, "axes.facecolor": "red", "svg.hashsalt": "other"}):
        again = write_figure(MAKERS[name](), tmp_path / "figure 1.2")
    assert [path.read_bytes() for path in again] == before
    with Image.open(first[0]) as image:
        assert image.width == round(200 * style.WIDTH)
        assert not {"Software", "Creation Time"} & set(image.info)
    text = first[1].read_text(encoding="utf-8")
    assert text.rstrip().endswith("</svg>")
    assert "<dc:date>" not in text


def test_a_figure_can_be_written_again(tmp_path: Path):
    figure = figure_schedules()
    one, two = write_figure(figure, tmp_path / "one"), write_figure(figure, tmp_path / "two")
    assert one[0].read_bytes() == two[0].read_bytes()
    assert one[1].read_bytes() == two[1].read_bytes()


def test_settings_stay_as_they_are_and_pyplot_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    names = [name for name in matplotlib.rcParams if name != "backend"]
    before = {name: matplotlib.rcParams[name] for name in names}
    write_figure(figure_schedules(), tmp_path / "figure")
    assert {name: matplotlib.rcParams[name] for name in names} == before


def test_where_it_cannot_be_written(tmp_path: Path):
    with pytest.raises(OutputError, match="does not exist"):
        write_figure(figure_schedules(), tmp_path / "none" / "figure")


@pytest.mark.parametrize("name", MAKERS)
def test_without_matplotlib_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, name: str):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "matplotlib.style", None)
    with pytest.raises(MissingExtraError, match=r'pip install "weingarten\[report\]"'):
        MAKERS[name]()

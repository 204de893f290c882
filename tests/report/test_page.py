"""The page from outside: made by the command, looked at as text."""

import json
import os
import re
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "cli"))
import benchmark as tiny
from checking import checked
from command import run, temporaries

from weingarten.bench.store import Store
from weingarten.errors import MissingExtraError
from weingarten.report import extra, side_by_side
from weingarten.report.page import Watcher, opened, parts_of, write_page
from weingarten.report.side_by_side import part_views


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tiny.make(tmp_path_factory.mktemp("bench") / "tiny")


@pytest.fixture(scope="module")
def made(folder: Path) -> tuple[Path, str, str]:
    """The page, and what the command said."""
    code, out, err = run("report", folder)
    assert code == 0, err
    return folder / "report.html", out, err


def test_the_command_says_what_it_wrote(made: tuple[Path, str, str]):
    path, out, err = made
    assert out.startswith(f"Wrote {path}: 16 fits, 4 contenders, 2 parts, ")
    assert "[2/2] " in err
    assert not temporaries(path.parent)


def test_it_is_whole_html_and_needs_nothing_else(made: tuple[Path, str, str]):
    text = made[0].read_text(encoding="utf-8")
    found = checked(text)
    assert not found.open
    assert len(found.ids) == len(set(found.ids))
    for address in found.addresses:
        assert address.startswith(("data:", "#")), address
        assert address == "data:," or not address.startswith("#") or address[1:] in found.ids
    assert not re.search(r"https?:|//cdn|@import|url\((?!#)", text)
    assert "default-src 'none'" in text


def test_names_and_sentences_are_escaped(made: tuple[Path, str, str]):
    text = made[0].read_text(encoding="utf-8")
    assert tiny.EVIL not in text
    assert "&lt;script&gt;document.title" in text
    for name in (tiny.ODD, tiny.PARTS[1], "<u>of the fit</u>"):
        assert name not in text
    shown = json.loads(re.search(r'id="viewing">(.*?)</script>', text)[1])
    assert [part["name"] for part in shown["parts"]] == sorted(tiny.PARTS)
    assert checked(text).titles[0].startswith("tiny")


def test_everything_that_was_promised_is_there(made: tuple[Path, str, str]):
    text = made[0].read_text(encoding="utf-8")
    for said in (
        "4 contenders on 2 parts, seeds 0 and 1: 16 fits, 4 of them failed.",
        "A machine, 2 cores",
        "0.1.0 (0123abc)",
        "2026-01-01 to 2026-01-02",
        "Means, protocol published-1",
        "Means, protocol exact-1",
        'class="best"',
        'class="second"',
        "Missed: truth to mesh",
        "in the unit of the file",
        "No curves: odd&lt;i&gt;&amp;&#39;, poisson.",
    ):
        assert said in text, said
    assert text.count('class="plot"') >= 12
    assert len(re.findall(r'<button type="button" class="shot"', text)) == 2 * (1 + 3 * 3)
    assert len(re.findall(r'<script type="text/plain" id="scene-', text)) == 2 * (1 + 3 * 2)


def test_the_same_folder_gives_the_same_bytes(made: tuple[Path, str, str], folder: Path, tmp_path: Path):
    code, _, err = run("report", folder, "-o", tmp_path / "again.html", "--quiet")
    assert code == 0
    assert err == ""
    assert (tmp_path / "again.html").read_bytes() == made[0].read_bytes()


def test_25_parts_of_8_contenders_stay_below_30_megabytes(made: tuple[Path, str, str]):
    """By the mean of these pictures, a third of them rough; scenes: at most 17 MB (test_scene.py)."""
    text = made[0].read_text(encoding="utf-8")
    pictures = [len(one) for one in re.findall(r'src="data:image/webp;base64,([^"]*)"', text)]
    scenes = re.compile(r'<script type="text/plain".*?</script>', re.DOTALL)
    rest = len(scenes.sub("", re.sub(r'src="data:[^"]*"', "", text)))
    mean = sum(pictures) / len(pictures)
    assert mean * 25 * (2 + 8 * 3) + 17e6 + 4 * rest < 30e6


def test_what_has_not_been_judged_is_said_and_shown(tmp_path: Path):
    """In this process, so that shapes and types are checked as well."""
    folder = tiny.make(tmp_path / "tiny", judged=False)
    seen: list[tuple[str, int, int]] = []

    class Listing(Watcher):
        def part(self, name: str, number: int, of: int) -> None:
            seen.append((name, number, of))

    made = write_page(folder, tmp_path / "page.html", Listing())
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert made.size == len(text.encode())
    assert [number for _, number, _ in seen] == [1, 2]
    assert "12 of the fits have not been compared with the truth yet" in text
    assert 'id="distributions"' not in text
    assert text.count('class="shot"') == 20
    assert not checked(text).open


def test_a_folder_whose_truths_are_gone(tmp_path: Path):
    folder = tiny.make(tmp_path / "tiny")
    for path in (folder / "given").iterdir():
        path.unlink()
    write_page(folder, tmp_path / "page.html", Watcher())
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert text.count("is no longer there, so errors cannot be drawn.") == 2
    assert text.count('class="shot"') == 6


@pytest.mark.slow
def test_parts_are_the_same_side_by_side(folder: Path, monkeypatch: pytest.MonkeyPatch):
    store, found = opened(folder)
    names = [tiny.SHIFTED, tiny.ODD]
    found = [one for one in found if one.contender in names]
    words = (store, found, parts_of(found), names, 500)
    alone = list(part_views(*words))
    monkeypatch.setattr(side_by_side, "FEW", 1)
    monkeypatch.setattr(side_by_side.os, "cpu_count", lambda: 2)
    assert list(part_views(*words)) == alone
    pool = side_by_side.ProcessPoolExecutor

    def dying(*arguments: object) -> object:
        return pool(*arguments[:2], os._exit, (1,))

    monkeypatch.setattr(side_by_side, "ProcessPoolExecutor", dying)
    assert list(part_views(*words)) == alone


def test_a_missing_extra_names_what_to_install(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "fast_simplification", None)
    with pytest.raises(
        MissingExtraError, match=r'fast_simplification; .* pip install "weingarten\[report\]"'
    ):
        extra.check()
    with pytest.raises(MissingExtraError):
        write_page(folder, tmp_path / "page.html", Watcher())
    assert not list(tmp_path.iterdir())


def test_only_failures_are_no_benchmark(tmp_path: Path):
    store = Store(tmp_path)
    entry = tiny.made(store.entry("plate", "odd", 0), None)
    record = tiny.record("plate", "odd", 0, tmp_path / "x.ply")
    entry.write_fit(record | {"status": "failed", "error": "No."})
    code, _, err = run("report", tmp_path)
    assert code == 2
    assert err.startswith("weingarten report: ")
    assert "no finished fit" in err

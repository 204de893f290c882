"""Every block of code in README.md, CONTRIBUTING.md and docs/ works: each page in a folder of its own.

Blocks of Python share one namespace a page; lines of shell are the command in this process, targets of the
Makefile, extras of pyproject.toml or scripts of this repository. A page finds `scan.ply`, `truth.stl` and
`parts/`, all of a bundled part. So that this takes seconds, presets have SMALL sizes, and some verbs get the
words in FEWER after their own; nothing else is otherwise than on the page.
"""

import re
import shlex
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from pieces import ROOT, Piece, mentioned, name, pages, pieces

from weingarten.cli.main import main, parser
from weingarten.io.cloud_file import write_cloud
from weingarten.io.mesh import write_mesh
from weingarten.samples.parts import part_mesh, sample_part
from weingarten.settings import PRESETS

SMALL = {"steps": 20, "points": 150, "resolution": 24, "width": 32, "depth": 3}
FEWER = {
    "sample": ["--points", "1500"],
    "mesh": ["--resolution", "32"],
    "bench": ["--seeds", "1", "--points", "1500"],
}
FOLLOWED = {"docs/adding-a-term.md": "tests/test_adding_a_term.py"}
"""Pages whose blocks make one thing together, and the test that does what they say."""

MOST_NOT_RUN = 4
"""How many blocks of all pages need not be run: another one needs a better reason than that it fails."""

MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
SHOWN = [page for page in pages() if pieces(page) and name(page) not in FOLLOWED]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where a page's blocks run, with what they find there."""
    for preset, settings in PRESETS.items():
        monkeypatch.setitem(PRESETS, preset, replace(settings, **SMALL))
    monkeypatch.chdir(tmp_path)
    write_cloud(tmp_path / "scan.ply", sample_part("flange", 1500, 0))
    write_mesh(tmp_path / "truth.stl", part_mesh("flange", 64))
    (tmp_path / "parts").mkdir()
    write_mesh(tmp_path / "parts/flange.stl", part_mesh("flange", 64))
    return tmp_path


@pytest.mark.parametrize("page", SHOWN, ids=name)
def test_what_a_page_shows_works(page: Path, folder: Path) -> None:
    namespace: dict[str, object] = {"__name__": "page"}
    for piece in pieces(page):
        if piece.kind in ("setup", "python"):
            code = compiled(page, piece)
            if not piece.reason:
                exec(code, namespace)
        elif piece.kind == "sh":
            for line in lines(piece.text):
                check(page, line, run=not piece.reason)


@pytest.mark.parametrize("page", pages(), ids=name)
def test_commands_within_the_text_are_commands(page: Path) -> None:
    for command in mentioned(page):
        check(page, shlex.split(command, comments=True), run=False)


def test_few_blocks_are_not_run() -> None:
    shown = {f"{name(page)}:{one.line}": one for page in pages() for one in pieces(page)}
    reasons = {place: one.reason for place, one in shown.items() if one.reason}
    assert len(reasons) <= MOST_NOT_RUN, reasons
    assert all(len(reason) > 10 for reason in reasons.values()), reasons


@pytest.mark.parametrize("page", pages(), ids=name)
def test_every_block_has_a_language_that_is_known(page: Path) -> None:
    assert {piece.kind for piece in pieces(page)} <= {"setup", "python", "sh", "text", "formula"}


def test_pages_that_are_followed_elsewhere_are() -> None:
    for page, test in FOLLOWED.items():
        assert page in (ROOT / test).read_text(encoding="utf-8")


@pytest.mark.parametrize("page", sorted(ROOT.glob("*.md")), ids=name)
def test_links_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\(([^)#:\s]+)\)", page.read_text(encoding="utf-8")):
        assert (page.parent / link).exists(), link


def compiled(page: Path, piece: Piece):
    """The code of a piece, whose errors name the page's own lines."""
    return compile("\n" * (piece.line - 1) + piece.text.strip(" "), str(page), "exec")


def lines(text: str) -> Iterator[list[str]]:
    """The commands of a block, split as a shell does, without comments."""
    for line in text.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if words:
            yield words


def check(page: Path, words: list[str], run: bool) -> None:
    """Run a command of this package, or parse it; see that any other is something of this repository."""
    program, *rest = words
    if Path(program).name == "weingarten":
        if run:
            assert main([*rest, *FEWER.get(rest[0], [])]) == 0, f"{name(page)}: {shlex.join(words)}"
        else:
            parser().parse_args(rest)
    elif program == "make":
        targets = [word for word in rest if "=" not in word]
        assert all(re.search(rf"^{target}:", MAKEFILE, re.MULTILINE) for target in targets), words
    elif "pip" in words:
        asked = ",".join(re.findall(r"\[(.*?)\]", shlex.join(words)))
        assert set(filter(None, asked.split(","))) <= set(PROJECT["optional-dependencies"]), words
    elif run:
        assert program.startswith("python"), f"{name(page)}: {program} is no command of this repository"
        assert (ROOT / rest[0]).exists(), f"{name(page)}: there is no {rest[0]}"

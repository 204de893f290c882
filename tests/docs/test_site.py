"""The site builds without a warning, holds every page, shows every public name and asks no other server.

Skipped where the extra `docs` is not installed, but for CI=true: there it fails.
"""

import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from pieces import ROOT

import weingarten

REQUESTED = re.compile(r"<(?:link|script|img|iframe)\b[^>]*?\b(?:href|src)=\"?((?:https?:)?//[^\s\">]+)")
"""What a browser fetches without being asked to, unlike a link."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if find_spec("mkdocs") is None or find_spec("material") is None or find_spec("mkdocstrings") is None:
        if os.environ.get("CI") == "true":
            pytest.fail("The extra docs is not installed, which CI needs for the site.")
        pytest.skip('The site needs: pip install "weingarten[docs]"')
    folder = tmp_path_factory.mktemp("site")
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return folder


def test_the_site(site: Path) -> None:
    pages = {page.relative_to(ROOT / "docs").with_suffix(".html") for page in (ROOT / "docs").rglob("*.md")}
    assert not [page for page in pages if not (site / page).exists()]
    assert (site / "CHANGELOG.html").exists()
    assert not list(site.rglob("*.py"))
    for page in site.rglob("*.html"):
        assert not REQUESTED.findall(page.read_text(encoding="utf-8")), page
    for sheet in site.rglob("*.css"):
        assert not re.findall(r"url\(\"?(?:https?:)?//", sheet.read_text(encoding="utf-8")), sheet
    start = (site / "api/index.html").read_text(encoding="utf-8")
    assert not [name for name in weingarten.__all__ if f'id="weingarten.{name}"' not in start]
    terms = (site / "api/terms.html").read_text(encoding="utf-8")
    modules = [path.stem for path in (ROOT / "src/weingarten/terms").glob("*.py") if path.stem != "__init__"]
    assert not [name for name in modules if f'id="weingarten.terms.{name}"' not in terms]

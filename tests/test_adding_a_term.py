"""docs/adding-a-term.md followed to the letter, on a copy of the package."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/adding-a-term.md"


def blocks() -> list[str]:
    """The code on the page, in order: the term, its import, its row, its test."""
    return re.findall(r"```(?:python|text)\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def python(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """The interpreter with the copy first on its path."""
    environment = {**os.environ, "PYTHONPATH": str(folder / "src")}
    return subprocess.run(
        [sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package after steps 1 to 3."""
    folder = tmp_path_factory.mktemp("copy")
    # with what Python and numba have compiled, which goes by the times of the files
    shutil.copytree(ROOT / "src/weingarten", folder / "src/weingarten")
    term, line, row, test = blocks()
    (folder / "src/weingarten/terms/willmore.py").write_text(term, encoding="utf-8")
    methods = folder / "src/weingarten/methods.py"
    text = methods.read_text(encoding="utf-8")
    last = "from weingarten.terms.term import"
    imported = text.replace(last, line + last, 1)
    begin = imported.index("METHODS = {")
    end = imported.index("\n    )\n}", begin) + 1
    methods.write_text(imported[:end] + row + imported[end:], encoding="utf-8")
    (folder / "tests/terms").mkdir(parents=True)
    (folder / "tests/terms/test_willmore.py").write_text(test, encoding="utf-8")
    return folder


def test_the_steps_name_the_files_that_they_change():
    headings = re.findall(r"^## \d\. .*`(.*)`$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert headings == [
        "src/weingarten/terms/willmore.py",
        "src/weingarten/methods.py",
        "tests/terms/test_willmore.py",
    ]


def test_the_new_term_passes_its_own_test(copy: Path):
    done = python(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/terms/test_willmore.py")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "9 passed" in done.stdout


def test_the_new_method_fits(copy: Path):
    points = np.random.default_rng(0).normal(size=(2000, 3))
    np.save(copy / "ball.npy", points / np.linalg.norm(points, axis=1, keepdims=True))
    words = ["-m", "weingarten", "fit", "ball.npy", "-o", "ball.stl"]
    words += ["--method", "willmore", "--schedule", "linear"]
    small = ["--steps", "60", "--points-per-step", "300", "--resolution", "24", "--quiet"]
    done = python(copy, *words, *small, "--run", "run")
    assert done.returncode == 0, done.stderr
    assert (copy / "ball.stl").stat().st_size > 1000
    assert "willmore" in next((copy / "run").glob("*.csv")).read_text(encoding="utf-8").splitlines()[0]

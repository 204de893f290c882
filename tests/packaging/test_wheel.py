"""The wheel: what is in it, and what someone does first who has installed it and no extras.

The environment that it is tried in holds the wheel alone and takes what the wheel requires from the one that
the tests run in, where the extras are blocked; so nothing is downloaded. `make bare` tries it with
`--installed` in an environment that really has nothing else.
"""

import shutil
import subprocess
import sys
import sysconfig
import venv
from email import message_from_bytes
from pathlib import Path
from zipfile import ZipFile

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from extras import DEVELOPING, PROJECT, ROOT, environment

FIRST = {
    "sample": ["bundled:flange", "-o", "scan.ply", "--points", "2000"],
    "fit": ["scan.ply", "-o", "part.stl", "--steps", "40", "--points-per-step", "200", "--resolution", "32"],
    "evaluate": ["part.stl", "bundled:flange"],
}
QUICK = ["--method", "igr"]
"""A method that compiles little: machine code is kept beside the package, and a test's environment is new."""

NEEDS_EXTRA = {
    "3mf": ["evaluate", "part.3mf", "bundled:flange"],
    "bench": ["bench", "parts", "--methods", "poisson", "--out", "compared"],
    "report": ["reproduce", "figures", "--out", "drawn"],
}
"""By extra, what cannot be done without it."""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built by way of the source archive, from a copy, for setuptools leaves things behind."""
    folder = tmp_path_factory.mktemp("source")
    without = shutil.ignore_patterns("__pycache__", "*.egg-info")
    shutil.copytree(ROOT / "src", folder / "src", ignore=without)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder)
    done = called(sys.executable, "-m", "build", "--no-isolation", "--outdir", "dist", folder=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return next((folder / "dist").glob("*.whl"))


@pytest.fixture
def given(request: pytest.FixtureRequest) -> str | None:
    """The interpreter that the wheel is said to be installed for."""
    return request.config.getoption("--installed")


@pytest.fixture
def interpreter(request: pytest.FixtureRequest, given: str | None, tmp_path: Path) -> Path:
    """That of an environment with the wheel in it."""
    if given is not None:
        return Path(given).absolute()
    venv.create(tmp_path / "fresh", with_pip=False, symlinks=True)
    python, wheel = tmp_path / "fresh/bin/python", request.getfixturevalue("wheel")
    install = ("install", "--quiet", "--no-index", "--no-deps", str(wheel))
    done = called(sys.executable, "-m", "pip", "--python", str(python), *install, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    # a plain path: the .pth files in that folder, an editable installation's among them, are not followed
    (libraries,) = (tmp_path / "fresh/lib").glob("python*/site-packages")
    (libraries / "required.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return python


def test_the_wheel_holds_the_package_and_nothing_else(wheel: Path) -> None:
    files = (
        path.relative_to(ROOT / "src") for path in (ROOT / "src/weingarten").rglob("*") if path.is_file()
    )
    with ZipFile(wheel) as archive:
        held = set(archive.namelist())
        about = next(path for path in held if path.endswith("/METADATA")).removesuffix("METADATA")
        metadata = message_from_bytes(archive.read(f"{about}METADATA"))
        licence, entries = (
            archive.read(f"{about}{name}") for name in ("licenses/LICENSE", "entry_points.txt")
        )
    package = {path for path in held if not path.startswith(about)}
    assert package == {path.as_posix() for path in files if "__pycache__" not in path.parts}
    pages = {"browser/page/palette.css", "report/page/benchmark.html", "view/page/view.html"}
    assert {f"weingarten/{name}" for name in {"py.typed"} | pages} <= package
    assert licence == (ROOT / "LICENSE").read_bytes()
    assert b"weingarten = weingarten.cli.main:command" in entries
    assert metadata["Version"] == PROJECT["version"]
    assert metadata["License-Expression"] == PROJECT["license"]
    assert metadata["Requires-Python"] == PROJECT["requires-python"]
    assert metadata["Description-Content-Type"] == "text/markdown"
    assert metadata.get_payload(decode=True) == (ROOT / "README.md").read_bytes()
    assert set(metadata.get_all("Provides-Extra", [])) == set(PROJECT["optional-dependencies"])


def test_what_someone_does_first(interpreter: Path, given: str | None, tmp_path: Path) -> None:
    program = str(interpreter.with_name("weingarten"))
    variables = environment(blocked=given is None)

    def answer(*words: str, code: int = 0) -> str:
        done = called(*words, folder=tmp_path, variables=variables)
        assert done.returncode == code, done.stdout + done.stderr
        return done.stdout + done.stderr

    place = answer(str(interpreter), "-c", "import weingarten; print(weingarten.__file__)")
    assert Path(place.strip()).is_relative_to(interpreter.parents[1])
    assert "weingarten fit scan.ply -o part.stl" in answer(str(interpreter), "-m", "weingarten", "--help")
    for verb, words in FIRST.items():
        answer(program, verb, *words, *(QUICK if verb == "fit" and given is None else []))
    if given is not None:  # its trial steps take ten seconds; test_without_extras asks it about the extras
        found = answer(program, "doctor")
        for extra in set(PROJECT["optional-dependencies"]) - DEVELOPING:
            assert f'missing: {extra} (pip install "weingarten[{extra}]")' in found
    (tmp_path / "part.3mf").write_bytes(b"what is in it does not matter")
    (tmp_path / "parts").mkdir()
    (tmp_path / "part.stl").rename(tmp_path / "parts/part.stl")
    for extra, words in NEEDS_EXTRA.items():
        said = answer(program, *words, code=2)
        assert said.endswith(f'install it with: pip install "weingarten[{extra}]"\n')
        assert "Traceback" not in said


def called(
    *words: str, folder: Path, variables: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """A program run to its end."""
    return subprocess.run(words, cwd=folder, env=variables, capture_output=True, text=True, timeout=300)

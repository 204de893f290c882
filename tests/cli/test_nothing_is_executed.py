"""A run folder from somewhere else is data: nothing in it is ever run, even when the command begins in it."""

import os
import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "fit"))
sys.path.insert(0, str(Path(__file__).parents[1] / "io"))
from bad_archives import zipped
from small import small_cloud, small_settings

from weingarten.reconstruction import reconstruct

MODULES = (
    "weingarten",
    "sitecustomize",
    "usercustomize",
    "numpy",
    "torch",
    "json",
    "safetensors",
    "numba",
    "site",
    "argparse",
)
SPRING = "from pathlib import Path; Path({place!r}).touch()\n"
KERNEL = "from weingarten.calculus import kernels; from numba.core.dispatcher import Dispatcher\n"
KERNEL += "print([own._cache.cache_path for own in vars(kernels).values() if isinstance(own, Dispatcher)])"


class Trap:
    """Whoever unpickles this leaves a trace."""

    def __init__(self, place: Path) -> None:
        self.place = place

    def __reduce__(self):
        return Path.touch, (self.place,)


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """A run folder with everything in it that some program might take for code of its own."""
    folder = tmp_path_factory.mktemp("run")
    reconstruct(small_cloud(), small_settings(), run_folder=folder)
    spring = SPRING.format(place=str(folder / "sprung"))
    for name in MODULES:
        (folder / f"{name}.py").write_text(spring)
        (folder / "weingarten").mkdir(exist_ok=True)
        (folder / "weingarten" / "__init__.py").write_text(spring)
    trap = pickle.dumps(Trap(folder / "sprung"))
    for name in (
        "state.pkl",
        "checkpoint.pt",
        "weights.pth",
        "cache/a.nbi",
        "__pycache__/weingarten.cpython-311.pyc",
    ):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(trap)
    (folder / ".numba_config.yaml").write_text(f"cache_dir: {folder / 'cache'}\n")
    (folder / "evil.pth").write_text(f"import os; {spring}")
    (folder / "matplotlibrc").write_text("backend: module://weingarten\n")
    (folder / "config.toml").write_text('[tool.weingarten]\nimport = "os.system"\n')
    (folder / "pyproject.toml").write_text('[project.entry-points."weingarten"]\nx = "weingarten:x"\n')
    return folder


def command() -> list[str]:
    """The installed command, else what it consists of; -P, because `-c` would look for modules here."""
    script = shutil.which("weingarten", path=str(Path(sys.executable).parent))
    return (
        [script]
        if script
        else [sys.executable, "-P", "-c", "from weingarten.cli.main import command; command()"]
    )


def test_a_mesh_is_made_in_a_folder_of_traps(run):
    words = [*command(), "mesh", ".", "-o", "again.ply"]
    said = subprocess.run(words, cwd=run, capture_output=True, text=True, timeout=300)
    assert said.returncode == 0, said.stderr
    assert (run / "again.ply").read_bytes() == (run / "mesh.ply").read_bytes()
    assert not (run / "sprung").exists()


def test_machine_code_is_not_taken_from_the_current_folder(run):
    """numba would read its settings there, and unpickle what lies in the cache that they name."""
    words = [sys.executable, "-P", "-c", KERNEL]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    said = subprocess.run(words, cwd=run, capture_output=True, text=True, timeout=300, env=environment)
    assert said.returncode == 0, said.stderr
    assert "numba" in said.stdout or "__pycache__" in said.stdout
    assert str(run) not in said.stdout
    assert not (run / "sprung").exists()


@pytest.mark.parametrize("name", ["cloud.npy", "checkpoint.safetensors"])
@pytest.mark.parametrize("kind", ["pickle", "objects", "archive"])
def test_traps_in_the_place_of_data(run, tmp_path, name, kind):
    """A pickle, an array of objects, an archive with a pickle as torch writes it."""
    from weingarten.cli.main import main

    trap = pickle.dumps(Trap(tmp_path / "sprung"))
    header = (
        b"\x93NUMPY\x01\x00v\x00"
        + b"{'descr': '|O', 'fortran_order': False, 'shape': (1,), }".ljust(117)
        + b"\n"
    )
    contents = {"pickle": trap, "objects": header + trap, "archive": zipped({"archive/data.pkl": trap})}
    for path in ("cloud.npy", "checkpoint.safetensors"):
        shutil.copy(run / path, tmp_path / path)
    (tmp_path / name).write_bytes(contents[kind])
    assert main(["mesh", str(tmp_path), "-o", str(tmp_path / "out.ply")]) == 2
    assert not (tmp_path / "sprung").exists()
    assert not (tmp_path / "out.ply").exists()

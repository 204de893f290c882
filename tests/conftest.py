"""Functions of the package check the types and shapes they are called with while tests run (type_checks.py).

One torch thread, so that float32 sums add up in the same order on every machine of a kind.
"""

import os

# before torch reads it; tests run side by side, one on a core, and so do the commands that they begin
os.environ.setdefault("OMP_NUM_THREADS", "1")
# else every command that tests begin would compile the whole package anew
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import torch
from hypothesis import HealthCheck, settings
from jaxtyping import install_import_hook

sys.path.insert(0, str(Path(__file__).parent))
# before the hook: what numba compiles cannot be wrapped
import weingarten.calculus.kernels
import weingarten.metrics.face_pairs  # noqa: F401
from type_checks import CALLS, check_at_first

if TYPE_CHECKING:
    from playwright.sync_api import Browser

check_at_first()
HOOK = install_import_hook("weingarten", "beartype.beartype")
torch.set_num_threads(1)
# A busy machine is slow, not wrong; and the same examples everywhere make a failure one that can be repeated.
settings.register_profile(
    "steady", deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
settings.load_profile("steady")

NAMES = ("chromium", "chromium-browser", "google-chrome")
ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--regenerate-golden` writes the loss curves of tests/fit/golden anew instead of comparing.

    `--installed` says where tests/packaging finds the wheel, instead of making an environment for it.
    """
    parser.addoption("--regenerate-golden", action="store_true", help="write tests/fit/golden/*.json anew")
    parser.addoption("--installed", metavar="PYTHON", help="interpreter that the wheel is installed for")


@pytest.fixture
def generator() -> torch.Generator:
    """A torch generator, seeded."""
    return torch.Generator().manual_seed(0)


@pytest.fixture(autouse=True)
def global_seed() -> None:
    """Nothing in the package draws from torch's global generator; tests that do get the same numbers."""
    torch.manual_seed(0)
    CALLS.clear()


@pytest.fixture(scope="module")
def browser() -> "Iterator[Browser]":
    """Chromium, headless. Without one tests are skipped, but for CI=true: there they fail."""
    program = next((path for name in NAMES if (path := shutil.which(name))), None)
    if program is None:
        if os.environ.get("CI") == "true":
            pytest.fail("There is no chromium, which CI needs for these tests; .ci/run installs it.")
        pytest.skip("There is no chromium.")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        yield browser
        browser.close()

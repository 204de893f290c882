"""Golden loss curves: 50 steps of every method with one small setting. A refactor must leave them alone.

Where a change of the loss is meant, write them anew and say so in the commit:

    python -m pytest tests/fit/test_golden.py --regenerate-golden
"""

import json
from pathlib import Path

import numpy as np
import pytest

from weingarten.methods import METHODS

GOLDEN = Path(__file__).parent / "golden"
SETTING = {"width": 32, "depth": 3, "points": 64, "steps": 50, "chunk": 40}
TOLERANCE = 1e-4
"""Random normal draws differ in their last float32 digit between processors."""


@pytest.mark.parametrize("name", METHODS)
def test_golden_loss_curve(make_loop, draws_for, name, pytestconfig):
    loop = make_loop(METHODS[name], draws=draws_for(METHODS[name]), double=True, **SETTING)
    curve = [loop.advance().loss for _ in range(50)]
    path = GOLDEN / f"{name}.json"
    if pytestconfig.getoption("regenerate_golden"):
        text = json.dumps({"setting": SETTING, "loss": [float(f"{loss:.9g}") for loss in curve]}, indent=1)
        path.write_text(text + "\n")
    golden = json.loads(path.read_text())
    assert golden["setting"] == SETTING
    np.testing.assert_allclose(curve, golden["loss"], rtol=TOLERANCE)


def test_no_golden_curve_is_left_over():
    assert {path.stem for path in GOLDEN.glob("*.json")} == set(METHODS)

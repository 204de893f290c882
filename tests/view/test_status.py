"""How far a fit is, in a sentence."""

import pytest

from weingarten.view.status import ENDED, RUNNING, SILENT, status


@pytest.mark.parametrize(
    ("step", "ended", "silent", "each", "kind", "said"),
    [
        (240, False, 1.0, 0.1, RUNNING, "Step 240 of 950, about 71 s left."),
        (0, False, 1.0, 0.0, RUNNING, "Step 0 of 950."),
        (950, False, 1.0, 0.1, RUNNING, "extracting the surface"),
        (950, True, 9e9, 0.1, ENDED, "Fitted, 950 steps."),
        (240, True, 9e9, 0.1, ENDED, "stopped there"),
        (240, False, 600.0, 0.1, SILENT, "nothing new for 10 min"),
        (240, False, 60.0, 9.0, RUNNING, "1.8 h left"),
    ],
)
def test_status(step, ended, silent, each, kind, said):
    found = status(step, 950, ended, silent, each)
    assert found.kind == kind
    assert said in found.text

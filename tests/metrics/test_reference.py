"""Both protocols against the slow ones of reference.py, to 1e-9, on real parts and a box."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
import reference
from shapes import BOX, TURN, abc_part, bent, needs_abc25, similar

from weingarten.metrics.exact import Exact
from weingarten.metrics.published import Published

FEW_FACES = ["abc_00010071", "abc_00010074", "abc_00010098", "abc_00016513", "abc_00180964"]


def compare(mesh, truth, count: int) -> None:
    found = Exact(samples=count, edge_samples=count // 4).evaluate(mesh, truth).values()
    assert found == pytest.approx(reference.exact(mesh, truth, count, count // 4), rel=0, abs=1e-9)
    found = Published(samples=5 * count).evaluate(mesh, truth).values()
    assert found == pytest.approx(reference.published(mesh, truth, 5 * count), rel=0, abs=1e-9)


def test_of_a_turned_box():
    compare(bent(similar(BOX, 3, TURN)), similar(BOX, 3, TURN), 200)


@pytest.mark.slow
@needs_abc25
@pytest.mark.parametrize("name", FEW_FACES)
def test_of_a_part_and_its_bent_copy(name: str):
    truth = abc_part(name)
    compare(bent(truth), truth, 200)

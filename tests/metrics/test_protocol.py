"""The table of protocols, and figures as values and as rows."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from shapes import SPHERE, similar

from weingarten.metrics.exact import Exact
from weingarten.metrics.figures import Figure, f1
from weingarten.metrics.protocol import EXACT, FIELD, PROTOCOLS, PUBLISHED


def test_names_and_table():
    assert PROTOCOLS == {"published": PUBLISHED, "exact": EXACT}
    assert (PUBLISHED.name, EXACT.name, FIELD.name) == ("published-1", "exact-1", "field-1")


def test_f1_of_nothing_is_zero():
    assert f1(np.ones(3), np.ones(3), 0.5) == 0
    assert f1(np.array([0.0, 1.0]), np.zeros(2), 0.5) == pytest.approx(2 / 3)


def test_rows_are_scaled_and_the_protocol_is_named():
    found = Exact(samples=1000).evaluate(similar(SPHERE, 1.01), SPHERE)
    rows = {row.name: row for row in found.rows()}
    assert rows["chamfer"].value == pytest.approx(1e3 * found.chamfer)
    assert rows["f1_005"].unit == "%"
    assert found.as_dict()["protocol"] == "exact-1"
    assert set(rows) == set(found.values())
    assert set(rows) | {"protocol", "flags"} == set(found.as_dict())
    texts = [rows[name].text for name in ("edge_f1", "watertight", "components", "f1_001", "unit_length")]
    assert texts == ["none", "yes", "1", "0.00", "2"]


def test_text_of_a_tiny_length_keeps_its_digits():
    assert Figure("unit_length", "", 1.25e-5, digits=".6g").text == "1.25e-05"

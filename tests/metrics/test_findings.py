"""Bad input: an error that says which mesh, or a figure that is None under a named flag; never a NaN."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from shapes import BOX, CUBE, NONE, joined, moved, opened, similar, turned_over

from weingarten.errors import InputError
from weingarten.mesh import Mesh
from weingarten.metrics.exact import Exact
from weingarten.metrics.published import Published

SMALL = (Exact(samples=2000, edge_samples=500), Published(samples=2000))
EXACT = SMALL[0]


def with_vertex(value: float) -> Mesh:
    vertices = BOX.vertices.copy()
    vertices[3, 1] = value
    return Mesh(vertices, BOX.faces)


WITHOUT_SURFACE = {
    "has no faces": NONE,
    "no finite extent": Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]])),
    "no face with an area": Mesh(np.array([[0.0, 0, 0], [1, 1, 1], [2, 2, 2]]), np.array([[0, 1, 2]])),
    "names a vertex which is not there": Mesh(BOX.vertices, BOX.faces + 1),
    "not finite": with_vertex(np.nan),
    "are not finite": with_vertex(np.inf),
}


@pytest.mark.parametrize("protocol", SMALL, ids=lambda protocol: protocol.name)
@pytest.mark.parametrize("words", WITHOUT_SURFACE)
def test_no_surface_is_an_error_that_says_which_mesh(protocol, words: str):
    bad = WITHOUT_SURFACE[words]
    with pytest.raises(InputError, match=f"^The mesh.*{words}"):
        protocol.evaluate(bad, BOX)
    with pytest.raises(InputError, match=f"^The truth.*{words}"):
        protocol.evaluate(BOX, bad)


def test_vertices_that_no_face_uses_do_no_harm():
    spare = Mesh(np.concatenate([BOX.vertices, [[np.nan, 1e9, 0.0]]]), BOX.faces)
    for protocol in SMALL:
        assert protocol.evaluate(spare, BOX).values() == protocol.evaluate(BOX, BOX).values()


def one_turned() -> Mesh:
    faces = BOX.faces.copy()
    faces[0] = faces[0, ::-1]
    return Mesh(BOX.vertices, faces)


def with_a_line(height: float) -> Mesh:
    """A box of which one face is split by a vertex on, or nearly on, one of its edges."""
    a, b, c = BOX.faces[0]
    middle = (BOX.vertices[a] + BOX.vertices[b]) / 2 + height * np.array([1.0, 1.0, 1.0])
    spare = len(BOX.vertices)
    faces = np.array([[a, spare, c], [spare, b, c], [a, b, spare]])
    return Mesh(np.concatenate([BOX.vertices, middle[None]]), np.concatenate([BOX.faces[1:], faces]))


LEAF = Mesh(np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2]]), np.array([[0, 1, 2], [0, 2, 1]]))
ODD = {
    "open": opened(BOX),
    "not-oriented": one_turned(),
    "inside-out": turned_over(BOX),
    "no-volume": LEAF,
    "bodies": joined(BOX, moved(BOX, 0, 0.6, 0)),
    "degenerate-faces": with_a_line(1e-15),
}


@pytest.mark.parametrize("protocol", SMALL, ids=lambda protocol: protocol.name)
@pytest.mark.parametrize("name", ODD)
def test_an_odd_mesh_is_measured_and_flagged(protocol, name: str):
    for mesh, truth, role in ((ODD[name], BOX, "mesh"), (BOX, ODD[name], "truth")):
        found = protocol.evaluate(mesh, truth)
        assert found.flags == (f"{role}-{name}",)
        assert role in found.findings[0].sentence
        answer = found.as_dict()
        assert json.loads(json.dumps(answer, allow_nan=False)) == answer
        assert answer["flags"] == [f"{role}-{name}"]


@pytest.mark.parametrize("name", ["open", "not-oriented", "no-volume"])
def test_without_an_inside_there_is_no_volume(name: str):
    assert EXACT.evaluate(ODD[name], BOX).volume_ratio is None
    assert EXACT.evaluate(BOX, ODD[name]).volume_ratio is None


def test_inside_out_changes_no_figure():
    right = EXACT.evaluate(BOX, similar(BOX, 1.01)).values()
    assert EXACT.evaluate(turned_over(BOX), similar(BOX, 1.01)).values() == pytest.approx(right, abs=2e-3)
    assert EXACT.evaluate(BOX, turned_over(similar(BOX, 1.01))).values() == pytest.approx(right, abs=2e-3)


def test_all_at_once():
    """A cavity is no second body that is inside out, but it is a second surface."""
    bad = joined(opened(BOX), moved(with_a_line(0.0), 0, 2, 0))
    assert EXACT.evaluate(bad, joined(CUBE, turned_over(similar(CUBE, 0.5)))).flags == (
        "truth-bodies",
        "mesh-open",
        "mesh-bodies",
        "mesh-degenerate-faces",
    )


@pytest.mark.parametrize("protocol", SMALL, ids=lambda protocol: protocol.name)
@pytest.mark.parametrize(
    ("scale", "words"), [(25.4, "25.4 times"), (1e-3, "0.001 times"), (3.1, "3.1 times")]
)
def test_other_units_are_flagged(protocol, scale: float, words: str):
    found = protocol.evaluate(similar(BOX, scale), BOX)
    assert found.flags == ("size-mismatch",)
    assert words in found.findings[0].sentence
    json.dumps(found.as_dict(), allow_nan=False)


@pytest.mark.parametrize("protocol", SMALL, ids=lambda protocol: protocol.name)
@pytest.mark.parametrize("size", [1e-7, 1e7])
def test_small_and_large_are_nothing_to_flag(protocol, size: float):
    assert protocol.evaluate(similar(BOX, size), similar(BOX, size)).flags == ()


def test_what_is_hardly_another_unit_is_not_flagged():
    assert EXACT.evaluate(similar(BOX, 2.9), BOX).flags == ()
    assert EXACT.evaluate(BOX, similar(BOX, 2.9)).flags == ()


def test_boxes_that_do_not_meet_are_flagged():
    assert EXACT.evaluate(moved(BOX, 0, 0.49, 0), BOX).flags == ()
    assert EXACT.evaluate(moved(BOX, 0, 0.51, 0), BOX).flags == ("boxes-apart",)
    assert EXACT.evaluate(moved(BOX, 0, 0, -0.3), BOX).flags == ("boxes-apart",)
    assert EXACT.evaluate(similar(BOX, 1e3, None, 1e4), BOX).flags == ("size-mismatch", "boxes-apart")

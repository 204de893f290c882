"""What the page is given of a ball is what is known of balls; what is not there is said."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from weingarten.errors import InputError
from weingarten.view.exhibit import Exhibit
from weingarten.view.item import item, opened
from weingarten.view.section import PLACES
from weingarten.view.subject import Look

sys.path.insert(0, str(Path(__file__).parent))
from exhibits import CENTRE, FRAME, OFF, RADIUS, Known, ball


def unzigzag(data: bytes, start: int, count: int, size: int) -> np.ndarray:
    planes = np.frombuffer(data, dtype=np.uint8)[start : start + size * count].reshape(size, count)
    values = sum(plane.astype(np.int64) << 8 * k for k, plane in enumerate(planes))
    return np.where(values % 2, -(values + 1) // 2, values // 2)


def places(said: dict, data: bytes) -> np.ndarray:
    """World positions of an item's vertices."""
    v = said["vertices"]
    steps = np.stack([np.cumsum(unzigzag(data, 2 * v * axis, v, 2)) for axis in range(3)], axis=1)
    return FRAME.to_world(np.array(said["low"]) + steps * said["step"])


@pytest.fixture(scope="module")
def exhibit() -> Exhibit:
    return ball()


def test_items_are_opened_again():
    assert opened(item({"a": [1, "ü"]}, b"\0\1")) == ({"a": [1, "ü"]}, b"\0\1")


def test_a_surface_is_the_mesh_and_offers_what_is_known_of_it(exhibit):
    said, data = opened(exhibit.scene(None))
    assert np.abs(np.linalg.norm(places(said, data) - CENTRE, axis=1) - RADIUS).max() < 0.03
    assert said["whole"] == 20 * 4**4
    assert [key for key, _ in said["colourings"]] == [
        "distance", "gap", "confidence", "mean", "gaussian", "lesser", "greater", "primitives"
    ]  # fmt: skip
    assert len(data) == 6 * said["vertices"] + 9 * said["faces"]


@pytest.mark.parametrize(
    ("by", "value"), [("mean", 0.2), ("gaussian", 0.04), ("lesser", 0.2), ("greater", 0.2)]
)
def test_curvatures_are_those_of_a_ball(exhibit, by, value):
    said, data = opened(exhibit.colours(by, None))
    assert said["map"] == "signed"
    assert said["ticks"][2] == [0.5, "0"]
    end = float(said["ticks"][4][1].removeprefix("≥ "))
    assert value <= end < 3 * value
    assert said["ticks"][0] == [0.0, f"≤ −{end:g}"]
    found = (np.frombuffer(data, dtype=np.uint8) / 255 * 2 - 1) * end
    assert np.abs(found - value).max() < 0.02 * end


def test_distance_is_that_of_the_points_around_from_the_mesh(exhibit):
    said, data = opened(exhibit.colours("distance", None))
    assert said["ticks"][-1] == [1.0, f"≥ {OFF:g}"] or said["ticks"][-1] == [1.0, "≥ 0.2"]
    end = float(said["ticks"][-1][1].split()[1])
    found = np.frombuffer(data, dtype=np.uint8) / 255 * end
    scene, content = opened(exhibit.scene(None))
    height = places(scene, content)[:, 2] - CENTRE[2]
    assert np.abs(found[height > 0.5] - OFF).max() < 0.02
    assert found[height < -0.5].max() < 0.02


def test_confidence_is_one_where_points_are(exhibit):
    said, data = opened(exhibit.colours("confidence", None))
    assert said["map"] == "trust"
    scene, content = opened(exhibit.scene(None))
    height = places(scene, content)[:, 2] - CENTRE[2]
    assert np.frombuffer(data, dtype=np.uint8)[height < -0.5].mean() > 250


def test_primitives_are_by_face(exhibit):
    said, data = opened(exhibit.colours("primitives", None))
    scene, content = opened(exhibit.scene(None))
    v, f = scene["vertices"], scene["faces"]
    first = np.cumsum(unzigzag(content, 6 * v, f, 3))
    height = places(scene, content)[first][:, 2] - CENTRE[2]
    paints = np.frombuffer(data, dtype=np.uint8)
    assert said["legend"] == [[1, "0 dome"]]
    assert (paints[height > 0.5] == 1).all()
    assert (paints[height < -0.5] == 0).all()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_section_is_the_distance_on_a_plane(exhibit, axis):
    at = 700
    said, data = opened(exhibit.section("xyz"[axis], at, None))
    box = exhibit.subject.box
    assert said["position"] == pytest.approx(box.lower[axis] + 0.7 * (box.upper - box.lower)[axis])
    rows, columns = said["rows"], said["columns"]
    values = np.cumsum(unzigzag(data, 0, rows * columns, 2)).reshape(rows, columns) * said["step"]
    across, up = (k for k in range(3) if k != axis)
    unit = np.zeros((rows, columns, 3))
    unit[..., axis] = FRAME.to_unit(
        np.full((1, 3), said["position"]) * np.eye(3)[axis] + CENTRE * (1 - np.eye(3)[axis])
    )[0, axis]
    unit[..., across] = np.linspace(said["low"][across], said["high"][across], columns)
    unit[..., up] = np.linspace(said["low"][up], said["high"][up], rows)[:, None]
    assert np.abs(values - (np.linalg.norm(unit, axis=2) - 1)).max() < 2e-4
    assert said["spacing"] * FRAME.scale == pytest.approx(0.2)
    assert exhibit.section("xyz"[axis], PLACES, None) != exhibit.section("xyz"[axis], 0, None)


def test_what_needs_a_field_or_points_is_absent_without():
    bare = Exhibit(Known(), 60_000)
    assert opened(bare.scene(None))[0]["colourings"] == []
    assert bare.facts()["box"] is None
    for ask in (
        lambda: bare.points(),
        lambda: bare.section("x", 1, None),
        lambda: bare.colours("mean", None),
        lambda: bare.colours("distance", None),
        lambda: bare.colours("primitives", None),
        lambda: bare.scene(7),
    ):
        with pytest.raises(InputError):
            ask()


def test_a_new_final_mesh_is_made_anew_and_an_old_one_is_kept():
    subject = Known()
    exhibit = Exhibit(subject, 60_000)
    first = exhibit.piece(subject.look(), None)
    assert exhibit.piece(subject.look(), None) is first
    subject.now = replace(subject.now, final="2")
    assert exhibit.piece(subject.look(), None) is not first
    subject.now = Look()
    with pytest.raises(InputError, match="no such surface"):
        exhibit.scene(None)


def test_the_curve_is_thinned_and_has_no_holes():
    loss = np.geomspace(100, 1, 5000)
    loss[7] = np.nan
    subject = Known(now=Look(curve={"step": np.arange(5000.0), "loss": loss}))
    curve = Exhibit(subject, 60_000).state()["curve"]
    assert len(curve["step"]) == len(curve["loss"]) <= 240
    assert (np.diff(curve["loss"]) < 0).all()
    assert Exhibit(Known(), 60_000).state()["curve"] == {"step": [], "loss": []}

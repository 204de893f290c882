"""Curvatures of exact surfaces from their fields alone, against closed forms; and the figure of them."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.exact import Box, Cone, Cylinder, Plane, Shape, Sphere, Torus
from weingarten.calculus.jet import TANGENT
from weingarten.report.camera import Camera
from weingarten.reproduce.curvature import REGIMES, Curvatures, Field, curvatures, on_surface
from weingarten.reproduce.figure_regimes import figure_regimes, marked_places, number, regime_views
from weingarten.reproduce.specimens import REACH, SPECIMENS

PANEL = 80

SHAPES: dict[str, Shape] = {
    "plane": Plane(normal=(1.0, 2.0, -0.5)),
    "sphere": Sphere(radius=0.7),
    "cylinder": Cylinder(radius=0.4),
    "cone": Cone((0.1, 0.0, 1.0), (0.0, 0.0, -1.0), 0.5),
    "torus": Torus(ring=0.8, tube=0.3),
    "box": Box(half=(0.5, 0.6, 0.7)),
}

REGIME_OF = {"plane": {0}, "sphere": {2}, "cylinder": {1}, "cone": {1}, "torus": {2, 3}, "box": {0}}

CLOSED_FORMS = {
    "box": [(0.0, 0.0)],
    "cylinder": [(1.0, 0.0)],
    "cone": [(np.sqrt(3.0), 0.0)],
    "sphere": [(1.0, 1.0)],
    "torus": [(2.5, 0.4 / (0.4 * 1.2)), (2.5, -0.4 / (0.4 * 0.4))],
    "groove": [(2.0, -2.0)],
}
"""κ₁, κ₂ at the marks, worked out by hand."""


def sampled(shape: Shape, count: int = 300) -> np.ndarray:
    """Random points of the surface within the unit cube."""
    points = on_surface(shape, np.random.default_rng(0).uniform(-0.9, 0.9, (count, 3)))
    return points[np.abs(points).max(axis=1) < 0.98]


@pytest.mark.parametrize("name", SHAPES)
def test_curvatures_agree_with_the_closed_forms(name: str):
    shape = SHAPES[name]
    points = sampled(shape)
    assert len(points) > 50
    assert shape(torch.from_numpy(points)).abs().max() < 1e-12
    found = curvatures(shape, points)
    expected = shape.curvatures(torch.from_numpy(points)).numpy()
    # The cone's apex and the torus' circle of equal slopes aside, rounding grows with curvature squared.
    scale = 1 + expected[:, 0] ** 2
    assert np.abs(found.first - expected[:, 0]).max() < 1e-9 * scale.max()
    assert np.abs(found.second - expected[:, 1]).max() < 1e-9 * scale.max()
    assert np.linalg.norm(found.normals, axis=1) == pytest.approx(1)
    assert set(found.regime.tolist()) == REGIME_OF[name]


def test_the_torus_is_hyperbolic_within_its_ring_and_elliptic_outside():
    shape = SHAPES["torus"]
    points = sampled(shape)
    outside = np.hypot(points[:, 0], points[:, 1]) > 0.8
    regime = np.array(REGIMES)[curvatures(shape, points).regime]
    assert (regime[outside] == "elliptic").all()
    assert (regime[~outside] == "hyperbolic").all()


@given(st.floats(-5, 5), st.floats(-5, 5))
def test_regime_is_that_of_the_signs(one: float, other: float):
    values = [0.0 if abs(value) < 1e-3 else value for value in (one, other)]
    both = Curvatures(np.zeros((1, 3)), np.array([max(values)]), np.array([min(values)]))
    zeros, product = values.count(0.0), values[0] * values[1]
    name = {2: "planar", 1: "parabolic", 0: "elliptic" if product > 0 else "hyperbolic"}[zeros]
    assert REGIMES[int(both.regime[0])] == name


@pytest.mark.parametrize("name", SHAPES)
def test_the_residual_is_the_mean_of_the_odw_term_over_frames(name: str):
    """|S₁₂| at evenly turned frames, averaged, against |κ₁ − κ₂|/π; n even turns are exact to 1/n²."""
    shape = SHAPES[name]
    points = torch.from_numpy(sampled(shape, 100))
    turns = torch.arange(360, dtype=torch.float64) * (torch.pi / 360)
    total = torch.zeros(len(points), dtype=torch.float64)
    for turn in turns:
        jet = Autodiff(Field(shape))(points, TANGENT, turn.expand(len(points)))
        total += jet.shape_operator[1].abs().detach()
    expected = curvatures(shape, points.numpy()).residual
    assert (total / len(turns)).numpy() == pytest.approx(expected, rel=1e-4, abs=1e-9)


def test_odw_is_zero_on_planes_and_spheres_and_not_on_cylinders():
    for name in ("plane", "box", "sphere"):
        assert np.abs(curvatures(SHAPES[name], sampled(SHAPES[name])).residual).max() < 1e-9
    cylinder = curvatures(SHAPES["cylinder"], sampled(SHAPES["cylinder"])).residual
    assert cylinder == pytest.approx(1 / (np.pi * 0.4))


@pytest.mark.parametrize("specimen", SPECIMENS, ids=lambda specimen: specimen.name)
def test_marks_have_the_curvatures_that_were_worked_out_by_hand(specimen):
    places = marked_places(specimen)
    found = curvatures(specimen.shape, places)
    expected = np.array(CLOSED_FORMS[specimen.name])
    assert np.stack([found.first, found.second], axis=1) == pytest.approx(expected, abs=1e-9)
    known = specimen.shape.curvatures(torch.from_numpy(places)).numpy()
    assert known == pytest.approx(expected, abs=1e-9)
    asked = np.array([mark.place for mark in specimen.marks])
    assert np.linalg.norm(places - asked, axis=1).max() < 0.15


def test_the_formulas_beneath_the_pictures_give_the_numbers_beside_them():
    values = {
        "0": lambda rho: 0.0,
        r"1/(\pi r)": lambda rho: 1 / np.pi,
        r"\cos\alpha/(\pi\rho)": lambda rho: np.cos(np.pi / 6) / (np.pi * rho),
    }
    rings = {"torus": (0.8, 0.4), "groove": (1.0, 0.5)}
    for specimen in SPECIMENS:
        places = marked_places(specimen)
        residual = curvatures(specimen.shape, places).residual
        for mark, place, own in zip(specimen.marks, places, residual, strict=True):
            rho = np.hypot(place[0], place[1])
            if specimen.name in rings:
                ring, tube = rings[specimen.name]
                assert mark.formula == r"R/(\pi r \rho)"
                assert own == pytest.approx(ring / (np.pi * tube * rho))
            else:
                assert own == pytest.approx(values[mark.formula](rho), abs=1e-9)


def test_views_show_every_regime_where_it_belongs():
    views = {view.specimen.name: view for view in regime_views(PANEL)}
    assert list(views) == [specimen.name for specimen in SPECIMENS]
    shown = {
        "box": {"planar"},
        "cylinder": {"planar", "parabolic"},
        "cone": {"parabolic"},
        "sphere": {"elliptic"},
        "torus": {"elliptic", "hyperbolic"},
        "groove": {"planar", "parabolic", "hyperbolic"},
    }
    for name, view in views.items():
        assert view.regimes.size == view.residuals.size == (PANEL, PANEL)
        marked = {REGIMES[int(index)] for index in view.at_marks.regime}
        assert marked <= shown[name]
        alpha = np.asarray(view.regimes)[..., 3]
        for column, row in view.marks:
            assert alpha[int(row), int(column)] == 255


@pytest.mark.parametrize("specimen", SPECIMENS, ids=lambda specimen: specimen.name)
def test_marks_are_in_sight(specimen):
    """Nothing of the solid is between a mark and the viewer."""
    back = Camera.around(np.array([[-REACH] * 3, [REACH] * 3]), PANEL).axes[2]
    for place in marked_places(specimen):
        ray = place + np.linspace(0.02, 3, 400)[:, None] * back
        assert specimen.shape(torch.from_numpy(ray)).min() > 0


def test_numbers():
    assert [number(value) for value in (0.0, -1e-12, 1.0, -2.5)] == ["0", "0", "{1.00}", "{-2.50}"]


def test_the_figure_has_a_picture_of_every_specimen_in_both_rows():
    figure = figure_regimes(panel=PANEL)
    assert sum(len(axes.images) for axes in figure.axes) == 2 * len(SPECIMENS) + 1
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert r"$1/(\pi r)={0.32}$" in texts
    assert "${1.00},\\ 0$" in texts

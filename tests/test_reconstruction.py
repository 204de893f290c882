"""The library's front door: units, fields of one's own, the field in world units."""

import numpy as np
import pytest
import torch
from torch import nn

import weingarten as wg
from weingarten import reconstruction
from weingarten.fit.loop import Record
from weingarten.fit.run_folder import opened
from weingarten.frame import Frame
from weingarten.metrics.topology import topology
from weingarten.observer import Observer
from weingarten.reconstruction import remesh
from weingarten.samples.parts import part_mesh, sample_part
from weingarten.scan import thinning
from weingarten.world_field import WorldField

SHORT = {"steps": 200, "points": 1000, "resolution": 32}
"""With 400 points a step, whether a ball of so few steps is one body depends on rounding."""

ROUND = {"method": "igr", "steps": 40, "points": 300, "resolution": 32}
"""A network that begins as a ball."""


def ball(count: int, radius: float, centre: float) -> np.ndarray:
    """Points on a sphere."""
    directions = np.random.default_rng(0).normal(size=(count, 3))
    return radius * directions / np.linalg.norm(directions, axis=1, keepdims=True) + centre


@pytest.mark.parametrize(
    ("radius", "centre", "settings"), [(1.0, 0.0, SHORT), (0.5, 1e6, ROUND), (5e-6, 1e-3, ROUND)]
)
def test_mesh_comes_back_in_the_clouds_frame_and_unit(radius, centre, settings):
    points = ball(3000, radius, centre)
    result = wg.reconstruct(points, wg.resolve(**settings))
    mesh = result.mesh
    assert topology(mesh).watertight
    np.testing.assert_allclose(mesh.bounds[0] - centre, -radius, rtol=0.25)
    np.testing.assert_allclose(mesh.bounds[1] - centre, radius, rtol=0.25)
    distance = np.abs(np.linalg.norm(mesh.vertices - centre, axis=1) - radius)
    assert np.median(distance) < 0.05 * radius
    assert result.summary.volume == pytest.approx(4 / 3 * np.pi * radius**3, rel=0.15)


def test_the_same_part_in_another_unit_is_the_same_mesh():
    points, brief = ball(2000, 1.0, 0.0), wg.resolve(**{**SHORT, "steps": 10, "points": 300, "sharp": False})
    here = wg.reconstruct(points, brief).mesh
    there = wg.reconstruct(points * 1024.0, brief).mesh
    np.testing.assert_array_equal(here.faces, there.faces)
    np.testing.assert_allclose(there.vertices, here.vertices * 1024.0, rtol=1e-12, atol=1e-9)


class Ball(nn.Module):
    """A sphere's exact field whose radius is learned."""

    def __init__(self, radius: float) -> None:
        super().__init__()
        self.radius = nn.Parameter(torch.tensor(radius))

    def forward(self, points: torch.Tensor) -> torch.Tensor:
        return points.norm(dim=-1) - self.radius


class Impatient(Observer):
    """Stops after some steps, and hears the notes."""

    def __init__(self, steps: int) -> None:
        self.left, self.notes = steps, []

    def note(self, text: str) -> None:
        self.notes.append(text)

    def step(self, record: Record, steps: int, seconds: float) -> None:
        self.left -= 1

    def interrupted(self) -> bool:
        return self.left <= 0


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("own", [True, False])
def test_only_a_fit_that_has_to_compile_says_so(compiled, own, monkeypatch):
    monkeypatch.setattr(reconstruction, "is_compiled", lambda: compiled)
    observer, settings = Impatient(1), wg.resolve(steps=2, points=20, resolution=16, sharp=False)
    module = Ball(0.9) if own else None
    wg.reconstruct(ball(500, 2.0, 5.0), settings, module=module, observer=observer)
    assert any("Compiling" in note for note in observer.notes) == (not compiled and not own)


def test_a_large_cloud_is_fitted_to_a_part_of_it_and_measured_by_all(tmp_path, monkeypatch):
    monkeypatch.setattr(thinning, "MOST_POINTS", 1500)
    points, settings = ball(4000, 2.0, 5.0), wg.resolve(steps=40, points=200, resolution=24, sharp=False)
    whole = wg.reconstruct(points, settings)
    assert whole.summary.points == 4000
    assert any("1,500 of the 4,000 points" in note for note in whole.summary.notes)
    observer = Impatient(15)
    part = wg.reconstruct(points, settings, run_folder=tmp_path / "run", observer=observer)
    assert not part.finished
    assert any("1,500 of the 4,000 points" in note for note in observer.notes)
    np.testing.assert_array_equal(np.load(tmp_path / "run" / "cloud.npy"), points)
    resumed = wg.reconstruct(points, settings, run_folder=tmp_path / "run", resume=True)
    np.testing.assert_array_equal(resumed.mesh.vertices, whole.mesh.vertices)
    np.testing.assert_array_equal(resumed.mesh.faces, whole.mesh.faces)
    again, _ = remesh(*opened(tmp_path / "run"), torch.device("cpu"), 24)
    np.testing.assert_array_equal(again.vertices, whole.mesh.vertices)


def test_surface_that_was_not_scanned_is_called_a_guess():
    points = ball(3000, 2.0, 5.0)
    cut, observer = points[points[:, 2] < 6.0], Impatient(1000)
    settings = wg.resolve(steps=40, points=200, resolution=24, sharp=False)
    summary = wg.reconstruct(cut, settings, observer=observer).summary
    assert summary.guessed > 0.02
    assert any("a guess" in doubt for doubt in summary.doubts)
    assert set(summary.doubts) <= set(observer.notes)
    assert summary.as_dict()["doubts"] == list(summary.doubts)


def test_any_torch_module_can_be_fitted():
    module = Ball(0.9)
    result = wg.reconstruct(
        ball(2000, 10.0, 3.0), wg.resolve(steps=300, points=100, resolution=32), module=module
    )
    # distances to the nearest of 2,000 samples exceed those to the sphere by some 0.02
    assert float(module.radius.detach()) == pytest.approx(1.0, abs=0.03)
    assert result.summary.genus == 0


def test_field_gives_distance_gradient_and_curvature_in_world_units():
    frame = Frame((100.0, 0.0, -50.0), 20.0)
    field = WorldField(Ball(0.5), frame)
    points = np.array([[115.0, 0.0, -50.0], [100.0, 5.0, -50.0], [100.0, 0.0, -30.0]])
    sample = field(points)
    np.testing.assert_allclose(sample.distance, [5.0, -5.0, 10.0], atol=1e-5)
    np.testing.assert_allclose(sample.gradient, [[1, 0, 0], [0, 1, 0], [0, 0, 1]], atol=1e-6)
    np.testing.assert_allclose(sample.curvatures[:, 0], [1 / 15, 1 / 5, 1 / 20], rtol=1e-4)
    np.testing.assert_allclose(sample.curvatures[:, 1], [1 / 15, 1 / 5, 1 / 20], rtol=1e-4)
    assert field(np.empty((0, 3))).gradient.shape == (0, 3)


@pytest.mark.slow
def test_standard_preset_on_a_bundled_part():
    """What a user gets by default: the right topology, and a mesh within a thousandth of the points."""
    result = wg.reconstruct(sample_part("bracket", 15_000, 0))
    truth = topology(part_mesh("bracket", 128))
    summary = result.summary
    assert summary.watertight
    assert (summary.components, summary.genus) == (truth.components, truth.genus)
    assert summary.distance_mean < 1e-3 * summary.diagonal
    assert summary.distance_p95 < 5e-3 * summary.diagonal
    assert summary.volume == pytest.approx(truth.volume, rel=0.01)


def test_names_of_the_public_api():
    for name in wg.__all__:
        assert getattr(wg, name) is not None
    assert callable(wg.reconstruct)
    assert callable(wg.reconstruct)
    with pytest.raises(AttributeError, match="no attribute"):
        _ = wg.nothing

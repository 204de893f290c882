"""Figure 3 from a small benchmark's folder whose errors are known."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import trimesh

from weingarten.bench.parts import Part
from weingarten.bench.store import Store, make_folder
from weingarten.errors import InputError, OptionError
from weingarten.io.mesh import write_mesh
from weingarten.mesh import Mesh
from weingarten.reproduce.figure_qualitative import figure_qualitative, judged_row

PANEL = 60
SPHERE = trimesh.creation.icosphere(4)


def ball(radius: float) -> Mesh:
    """Far from the origin, as parts are."""
    return Mesh(40 * radius * np.array(SPHERE.vertices) + 100.0, np.array(SPHERE.faces, dtype=np.int64))


@pytest.fixture
def part(tmp_path: Path) -> Part:
    """A ball, with a folder of contenders: the truth itself, one too large, one without a mesh."""
    truth = tmp_path / "ball.ply"
    write_mesh(truth, ball(1.0))
    store = Store(tmp_path / "bench")
    for name, radius in {"right": 1.0, "large": 1.02}.items():
        entry = store.entry("ball", name, 0)
        make_folder(entry.folder)
        write_mesh(entry.mesh_path, ball(radius))
        entry.write_figures({"exact-1": {"chamfer": (radius - 1) / 2}})
    make_folder(store.entry("ball", "failed", 0).folder)
    return Part("ball", truth)


def test_distances_are_to_the_truth_in_its_unit_cube(tmp_path: Path, part: Part):
    row = judged_row(Store(tmp_path / "bench"), part, ["right", "large", "failed"], 0, PANEL)
    right, large, failed = row.judged
    assert right is not None
    assert large is not None
    assert failed is None
    assert right.distance.max() < 1e-6
    assert large.distance == pytest.approx(0.01, rel=0.02)
    assert large.chamfer == pytest.approx(0.01)
    assert row.truth.camera is large.panel.camera
    assert large.panel.seen.sum() > row.truth.seen.sum()


def test_the_figure_has_a_picture_for_every_mesh(tmp_path: Path, part: Part):
    contenders = {"exact": "right", "too large": "large"}
    figure = figure_qualitative(tmp_path / "bench", [part, part], contenders, panel=PANEL)
    assert sum(len(axes.images) for axes in figure.axes) == 2 * 3 + 1
    texts = [text.get_text() for text in figure.texts]
    assert texts[:3] == ["truth", "exact", "too large"]
    assert texts[3:6] == ["ball", "CD 0.00", "CD 10.00"]
    ticks = [tick.get_text() for tick in figure.axes[-1].get_xticklabels()]
    assert ticks == ["0", "0.25", "0.5", "0.75", "≥ 1"]


def test_long_headings_stay_above_their_column(tmp_path: Path, part: Part):
    contenders = dict.fromkeys(("neural-singular-hessian", "smaller-curvature", "a", "b", "c"), "right")
    figure = figure_qualitative(tmp_path / "bench", [part], contenders, panel=PANEL)
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in figure.texts[: len(contenders) + 1]]
    assert all(one.x1 < other.x0 for one, other in pairwise(boxes))
    assert max(box.y1 for box in boxes) <= figure.bbox.y1
    assert min(box.y0 for box in boxes) >= figure.axes[0].get_window_extent().y1


def test_the_scale_can_be_given_and_failures_are_shown(tmp_path: Path, part: Part):
    other = Part("other", part.truth)
    figure = figure_qualitative(tmp_path / "bench", [part, other], {"large": "large"}, end=0.02, panel=PANEL)
    assert [tick.get_text() for tick in figure.axes[-1].get_xticklabels()][-1] == "≥ 20"
    assert [text.get_text() for axes in figure.axes for text in axes.texts] == ["no mesh"]


def test_what_cannot_be_compared_is_refused(tmp_path: Path, part: Part):
    folder = tmp_path / "bench"
    with pytest.raises(InputError, match="no mesh by 'nobody' with seed 0 of ball"):
        figure_qualitative(folder, [part], {"x": "nobody"})
    with pytest.raises(InputError, match="no mesh by 'failed'"):
        figure_qualitative(folder, [part], {"x": "failed"})
    for parts, contenders, end in (
        ([], {"x": "right"}, None),
        ([part], {}, None),
        ([part], {"x": "right"}, 0.0),
    ):
        with pytest.raises(OptionError):
            figure_qualitative(folder, parts, contenders, end=end)

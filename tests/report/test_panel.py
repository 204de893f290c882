"""One panel: what is seen lies on the surface; images are what they were, and as opaque as they should be."""

import numpy as np
import pytest
import trimesh

from weingarten.mesh import Mesh
from weingarten.report.camera import SUPERSAMPLING, Camera
from weingarten.report.panel import cut_out, reduced, seen
from weingarten.report.picture import picture

BALL = trimesh.creation.icosphere(4)
MESH = Mesh(np.array(BALL.vertices), np.array(BALL.faces, dtype=np.int64))
PANEL = 200
CAMERA = Camera.around(MESH.vertices, PANEL)


def test_seen_places_lie_on_the_near_side_of_the_surface():
    panel = seen(MESH, CAMERA)
    assert np.linalg.norm(panel.positions, axis=1) == pytest.approx(1, abs=2e-3)
    assert (panel.positions @ CAMERA.axes[2]).min() > -0.05


def test_the_picture_shows_the_shaded_panel():
    points = np.zeros((0, 3))
    whole = np.asarray(picture(points, MESH, panel=PANEL))
    alone = np.asarray(reduced(seen(MESH, CAMERA).shaded()))
    assert np.array_equal(whole[: len(alone), PANEL:], alone)


def test_a_cut_out_is_opaque_inside_clear_outside_and_in_between_at_the_rim():
    panel = seen(MESH, CAMERA)
    image = np.asarray(cut_out(panel.shaded(), panel.seen))
    assert image.shape == (PANEL, PANEL, 4)
    alpha = image[..., 3]
    assert alpha[PANEL // 2, PANEL // 2] == 255
    assert alpha[0, 0] == 0
    assert set(np.unique(alpha)) <= {round(255 * k / SUPERSAMPLING**2) for k in range(5)}
    solid = alpha == 255
    assert np.array_equal(image[solid][:, :3], np.asarray(reduced(panel.shaded()))[solid])
    assert image[(alpha > 0) & ~solid][:, :3].max() < 250, "the background's white does not bleed in"


def test_colours_keep_their_hue_in_light_and_shade():
    panel = seen(MESH, CAMERA)
    red = panel.coloured(np.tile([0.8, 0.1, 0.1], (len(panel.face), 1)))[panel.seen]
    assert (red[:, 0] > 3 * red[:, 1]).all()
    assert np.ptp(red[:, 0]) > 0.1

"""What is seen from the sides of a part, and what the view in 3D is told."""

import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

sys.path.insert(0, str(Path(__file__).parents[1]))
from one_run import box, cloud

from weingarten.mesh import Mesh
from weingarten.report.camera import Camera
from weingarten.report.panel import seen
from weingarten.report.run.colours import Colours
from weingarten.report.run.deviation import Deviation
from weingarten.report.run.pictures import SIDES, drawn, pair, points_picture, sides, viewing
from weingarten.report.shading import EVEN, brightness


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


@pytest.mark.parametrize(
    "shape", [trimesh.creation.icosphere(3), trimesh.creation.box((4, 2, 1)).subdivide()]
)
def test_no_face_of_a_convex_part_is_hidden_from_all_sides(shape: trimesh.Trimesh):
    mesh = as_mesh(shape)
    found = set()
    for _, azimuth, elevation in SIDES:
        camera = Camera.around(mesh.vertices, 300, azimuth, elevation)
        found |= set(seen(mesh, camera).face.tolist())
    assert found == set(range(len(mesh.faces)))


def test_faces_seen_from_below_are_lit_as_well():
    below = np.array([[0.0, -0.87, 0.5]])
    assert brightness(below, EVEN)[0] > 1.5 * brightness(below)[0]


def test_pictures_and_scene_of_a_mesh():
    mesh, points = box(), cloud()
    deviation = Deviation.of(mesh, points)
    colours = Colours.of(deviation.value, deviation.signed, 17.0)
    made = sides(mesh, deviation, colours)
    assert [one.title for one in made] == [title for title, _, _ in SIDES]
    assert all(one.uri.startswith("data:image/webp;base64,") for one in [*made, *pair(points, mesh)])
    assert points_picture(points).width == 600
    assert drawn(mesh) is mesh
    settings, scenes = viewing("a part", mesh, deviation, colours)
    part = settings["parts"][0]
    assert part["meshes"][0]["captions"]["error"].startswith(
        "a part: deviation of the points, in the cloud’s unit"
    )
    assert settings["unknown"]
    assert [key for key, _ in scenes] == ["scene-0-0"]

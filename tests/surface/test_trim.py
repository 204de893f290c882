"""Surface far from all points is left out; what is near stays as it is."""

import numpy as np
import pytest
from trimesh.creation import icosphere

from weingarten.errors import ExtractionError
from weingarten.mesh import Mesh
from weingarten.scan.sampling import sample_surface
from weingarten.surface.trim import trimmed

BALL = Mesh(*(np.asarray(part) for part in (icosphere(4).vertices, icosphere(4).faces)))
POINTS = sample_surface(BALL, 5000, 0)[0]


def test_a_mesh_all_near_the_points_stays():
    found = trimmed(BALL, POINTS, 0.2)
    np.testing.assert_array_equal(found.corners, BALL.corners)


def test_the_half_without_points_goes_but_for_the_distance():
    found = trimmed(BALL, POINTS[POINTS[:, 2] > 0.0], 0.1)
    assert -0.1 < found.vertices[:, 2].min() < -0.03
    assert found.vertices[:, 2].max() == pytest.approx(BALL.vertices[:, 2].max())
    assert set(found.faces.ravel()) == set(range(len(found.vertices)))
    whole = {tuple(map(tuple, corners)) for corners in BALL.corners}
    assert {tuple(map(tuple, corners)) for corners in found.corners} < whole


def test_nothing_left_is_an_error():
    with pytest.raises(ExtractionError, match="--trim-distance"):
        trimmed(BALL, POINTS + 10.0, 0.1)

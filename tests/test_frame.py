"""World ↔ unit, against the obvious way."""

import numpy as np
import pytest

from weingarten.frame import Frame


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize(("scale", "offset"), [(1.0, 0.0), (1e-5, 1e3), (37.0, -1e6), (1e150, 0.0)])
def test_the_farthest_coordinate_is_one(scale, offset, seed):
    points = np.random.default_rng(seed).normal(size=(50, 3)) * scale + offset
    frame = Frame.of(points)
    assert frame.scale == np.abs(points - points.mean(axis=0)).max()
    assert np.abs(frame.to_unit(points)).max() == 1.0
    np.testing.assert_allclose(frame.to_world(frame.to_unit(points)), points, rtol=1e-12)

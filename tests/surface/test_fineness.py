"""Thin walls get a finer lattice, in bounds."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from weingarten.calculus.exact import Box
from weingarten.fit.checkpoint import Origin
from weingarten.frame import Frame
from weingarten.metrics.topology import topology
from weingarten.reconstruction import fineness_notes
from weingarten.settings import resolve
from weingarten.surface.contour import extract
from weingarten.surface.fineness import CELLS, FINEST, cells_along


@given(st.integers(8, 4096), st.floats(0.1, 10.0), st.floats(1e-6, 10.0))
def test_cells_are_those_asked_for_or_fit_the_walls_or_are_twice_as_many(resolution, longest, apart):
    cells = cells_along(resolution, longest, apart)
    assert resolution <= cells <= FINEST * resolution
    if resolution < cells < FINEST * resolution:
        assert cells - 1 < CELLS * longest / apart <= cells
    if cells == resolution:
        assert apart >= CELLS * longest / cells * (1.0 - 1e-12)


def test_a_wall_that_is_torn_is_whole_on_the_finer_lattice():
    """A plate of 0.6 cells, tilted so that nodes miss it."""
    tilt = np.array([0.03, 0.02, 1.0]) / np.linalg.norm([0.03, 0.02, 1.0])
    side = np.cross(tilt, [0.0, 1.0, 0.0])
    axes = np.stack([side / np.linalg.norm(side), np.cross(tilt, side / np.linalg.norm(side)), tilt])
    thickness, resolution = 0.6 * 2.0 / 64, 64
    plate = Box((0.0, 0.0, 0.0), (0.8, 0.8, thickness / 2.0))

    def values(points):
        return plate(points.double() @ torch.from_numpy(axes).T)

    corner = np.ones(3)
    pieces = {
        cells: topology(extract(values, -corner, corner, cells)) for cells in (resolution, 4 * resolution)
    }
    assert pieces[resolution].genus != 0 or pieces[resolution].components > 1
    assert (pieces[4 * resolution].genus, pieces[4 * resolution].components) == (0, 1)


@pytest.mark.parametrize(("apart", "cells"), [(2.2, 256), (0.02, 263), (0.001, 512)])
def test_a_fit_says_when_its_lattice_is_finer(apart, cells):
    box = (-1.05, -0.5, -0.5), (1.05, 0.5, 0.5)
    origin = Origin(resolve(), Frame((0.0, 0.0, 0.0), 10.0), "", *box, apart)
    assert origin.cells == cells
    notes = fineness_notes(origin)
    assert len(notes) == (cells > 256)
    for note in notes:
        assert f"as thin as {10.0 * apart:.3g}" in note
        assert f"{cells} cells" in note

"""A cross-section of a field: its values on a plane across one axis, for level lines that the page draws.

The page is given distances on a lattice, as whole STEPS of the unit frame, at most FARTHEST of them. Axes are
those of the world; unit and world frame differ by scale and offset alone.
"""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float64

from weingarten.crew import crew_for
from weingarten.report.heat import rounded_up
from weingarten.report.scene import difference_plane
from weingarten.surface.values import field_values
from weingarten.view.item import item
from weingarten.world_field import WorldField

AXES = "xyz"
PLACES = 1000
"""A place on an axis is a whole number from 0 to so many, from the lower side of the box to the upper one."""

ACROSS = 220
"""Values along the longer side of a section."""

STEPS, FARTHEST = 8192, 16_383
LINES = 100
"""Level lines along the box's longest side, about."""

Corner = Float64[np.ndarray, " 3"]


@dataclass(frozen=True)
class Box:
    """Where sections are taken, world frame."""

    lower: Corner
    upper: Corner

    @property
    def spacing(self) -> float:
        """Of level lines, in the unit of the cloud: 1, 2 or 5 times a power of ten."""
        return rounded_up(float((self.upper - self.lower).max()) / LINES)

    def position(self, axis: int, place: int) -> float:
        """The coordinate of a place on an axis, world unit."""
        return float(self.lower[axis] + (self.upper[axis] - self.lower[axis]) * place / PLACES)


def section(field: WorldField, box: Box, axis: int, place: int) -> bytes:
    """The item of a section. low, high: its corners in the unit frame; rows run along the later axis."""
    across, up = (other for other in range(3) if other != axis)
    side = float(max(box.upper[across] - box.lower[across], box.upper[up] - box.lower[up]))
    columns, rows = (
        max(2, int(np.ceil(ACROSS * (box.upper[k] - box.lower[k]) / side)) + 1) for k in (across, up)
    )
    position = box.position(axis, place)
    points = np.empty((rows, columns, 3))
    points[..., axis] = position
    points[..., across] = np.linspace(box.lower[across], box.upper[across], columns)
    points[..., up] = np.linspace(box.lower[up], box.upper[up], rows)[:, None]
    unit = field.frame.to_unit(points.reshape(-1, 3))
    values = field_values(field.module, crew_for(next(field.module.parameters()).device))
    distance = values(torch.from_numpy(unit.astype(np.float32))).double().cpu().numpy()
    steps = np.round(np.nan_to_num(distance) * STEPS).clip(-FARTHEST, FARTHEST).astype(np.int64)
    said = {
        "axis": axis,
        "position": position,
        "columns": columns,
        "rows": rows,
        "low": unit[0].tolist(),
        "high": unit[-1].tolist(),
        "step": 1 / STEPS,
        "spacing": box.spacing / field.frame.scale,
    }
    return item(said, difference_plane(steps, 2))

"""From a fitted part to its primitives."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from weingarten.frame import Frame
from weingarten.measure.free_form import free_patches
from weingarten.measure.growing import Region
from weingarten.measure.labels import NONE, Labels, label_areas, labelled
from weingarten.measure.narrow import flattened, narrow_planes
from weingarten.measure.plane import Plane
from weingarten.measure.primitive import Primitive
from weingarten.measure.related import related
from weingarten.measure.segmentation import segmented
from weingarten.measure.settling import facing, merged, needed, settled
from weingarten.measure.skin import Skin, WorldFunction
from weingarten.measure.surface import Points
from weingarten.mesh import Mesh

MOST_POINTS = 60_000
"""Primitives are told from so many points, evenly picked from the cloud."""

TOLERANCE, SIGMAS = 0.1, 1.5
"""Points are on a surface as near as TOLERANCE spacings, or SIGMAS standard deviations of their noise,
most of which the field has taken from where they are told to be (`Skin.places`)."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """What there is on a part; lengths in its cloud's unit.

    primitives: the largest first. labels: of every vertex of the mesh, the number of its primitive, or −1
    where it is free-form. free_area, area: of the free-form surface, and of all;
    free_patches: its larger pieces (`free_patches`). noise: standard deviation of the
    points from their surface, 0 where none is certain. tolerance: how near points are to a surface that
    they count as on it.
    """

    primitives: tuple[Primitive, ...]
    labels: Labels
    free_area: float
    free_patches: tuple[dict[str, Any], ...]
    area: float
    noise: float
    tolerance: float

    @property
    def free_share(self) -> float:
        """Of the area."""
        return self.free_area / self.area if self.area else 0.0

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON; `number` is what the labels say."""
        rows = [{"number": n, **primitive.as_dict()} for n, primitive in enumerate(self.primitives)]
        return {
            "primitives": rows,
            "free_form": {
                "area": self.free_area,
                "share": self.free_share,
                "patches": list(self.free_patches),
            },
            "area": self.area,
            "noise": self.noise,
            "tolerance": self.tolerance,
            "vertices": len(self.labels),
        }


def measurement(mesh: Mesh, field: WorldFunction, points: Points) -> Measurement:
    """The planes, cylinders, cones, spheres and tori that a fitted part is made of.

    mesh: of the part. field: callable on (n, 3) points, as `WorldField`. points: of the cloud that it was
    fitted to; on these, the surfaces are fitted. All in one frame and unit.
    """
    frame = Frame.of(points)
    chosen = points[:: max(1, -(-len(points) // MOST_POINTS))]
    skin = Skin.of(chosen, field, frame)
    tolerance = float(np.hypot(TOLERANCE * skin.spacing, SIGMAS * skin.noise))
    regions = settled(segmented(skin, tolerance), skin, tolerance)
    regions = flattened(regions, skin, tolerance)
    regions = needed(merged(regions, skin, tolerance), skin, tolerance)
    regions = settled(regions, skin, tolerance)
    regions = settled(merged(regions, skin, tolerance), skin, tolerance)
    regions += narrow_planes(regions, skin, tolerance)
    unit = Mesh(frame.to_unit(mesh.vertices), mesh.faces)
    labels = labelled(unit, regions, skin)
    areas, _ = label_areas(unit, labels, len(regions))
    order = np.argsort(-areas, kind="stable")
    order = order[areas[order] > 0.0]
    rank = np.full(len(regions) + 1, NONE, dtype=np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    labels = rank[labels]
    areas, free = label_areas(mesh, labels, len(order))
    whole = float(mesh.areas.sum())
    found = [primitive(regions[k], skin, frame, float(areas[n]), whole) for n, k in enumerate(order)]
    near = tolerance * frame.scale
    return Measurement(
        related(found, near), labels, free, free_patches(mesh, labels), whole, skin.noise * frame.scale, near
    )


def primitive(region: Region, skin: Skin, frame: Frame, area: float, whole: float) -> Primitive:
    """A region of the unit frame in the world, with its figures."""
    points = skin.points[region.members]
    distance = np.abs(region.surface.distance(points)) * frame.scale
    surface = region.surface.centred(points).placed(frame)
    outside = facing(region, skin)
    if isinstance(surface, Plane) and not outside:
        surface = surface.turned
    return Primitive(
        surface=surface,
        side=None if isinstance(surface, Plane) else "boss" if outside else "hole",
        extent=surface.extent(frame.to_world(points), area),
        points=len(region.members),
        rms=float(np.sqrt((distance**2).mean())),
        p95=float(np.quantile(distance, 0.95)),
        area=area,
        share=area / whole,
    )

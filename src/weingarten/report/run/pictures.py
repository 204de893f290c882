"""Pictures of a fit: points beside mesh; the mesh coloured by deviations, from all sides; and its scene."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from weingarten.mesh import Mesh
from weingarten.metrics.unit_cube import cube_frame
from weingarten.report import scene as packing
from weingarten.report.camera import AZIMUTH, ELEVATION, SUPERSAMPLING, Camera
from weingarten.report.gallery import DRAWN, as_tuple
from weingarten.report.heat import seen_places
from weingarten.report.image import data_uri
from weingarten.report.panel import cut_out, reduced, seen
from weingarten.report.picture import drawn_points
from weingarten.report.refine import Levels
from weingarten.report.run.colours import Colours
from weingarten.report.run.deviation import Deviation
from weingarten.report.scene import Scene
from weingarten.report.shading import EVEN
from weingarten.report.simplify import simplified
from weingarten.report.viewing import placed, scene_settings, settings_of

Points = Float64[np.ndarray, "n 3"]

WIDE, NARROW = 600, 460
"""Widths of pictures, pixels: of points and mesh, and of each side."""
LARGE = 90_000
"""Bytes of a picture of points, at most if possible."""
SIDES = (
    ("Front, from above", AZIMUTH, ELEVATION),
    ("Back, from above", AZIMUTH + np.pi, ELEVATION),
    ("Front, from below", AZIMUTH, -ELEVATION),
    ("Back, from below", AZIMUTH + np.pi, -ELEVATION),
)
"""Name, azimuth and elevation of every side. The first looks against the last, the second against the third:
what one of two opposite views sees edge-on or from behind, the other or the next pair sees."""
MODES = (("shaded", "Shaded"), ("error", "Deviation"))


@dataclass(frozen=True)
class Picture:
    """title: the side. uri: the image as data. width, height: in pixels. azimuth, elevation: degrees."""

    title: str
    uri: str
    width: int
    height: int
    azimuth: float
    elevation: float


def points_picture(points: Points) -> Picture:
    """The points from the first side."""
    title, azimuth, elevation = SIDES[0]
    camera = Camera.around(points, WIDE, azimuth, elevation)
    return of(title, data_uri(reduced(drawn_points(points, camera)), LARGE), camera, azimuth, elevation)


def pair(points: Points, mesh: Mesh) -> tuple[Picture, Picture]:
    """The points and the mesh, by one camera from the first side."""
    title, azimuth, elevation = SIDES[0]
    camera = Camera.around(np.concatenate([points, mesh.corners.reshape(-1, 3)]), WIDE, azimuth, elevation)
    panel = seen(mesh, camera)
    images = (reduced(drawn_points(points, camera)), reduced(panel.shaded()))
    one, other = (of(title, data_uri(image, LARGE), camera, azimuth, elevation) for image in images)
    return one, other


def sides(mesh: Mesh, deviation: Deviation, colours: Colours) -> list[Picture]:
    """The mesh in the colours of its deviations, from every side."""
    pictures = []
    for title, azimuth, elevation in SIDES:
        camera = Camera.around(mesh.corners.reshape(-1, 3), NARROW, azimuth, elevation)
        panel = seen(mesh, camera)
        places, which = seen_places(panel)
        painted = panel.coloured(colours.colours(deviation.at(places))[which], EVEN)
        image = cut_out(painted, panel.seen)
        pictures.append(of(title, data_uri(image, LARGE), camera, azimuth, elevation))
    return pictures


def of(title: str, uri: str, camera: Camera, azimuth: float, elevation: float) -> Picture:
    """A picture that this camera took."""
    width, height = camera.width // SUPERSAMPLING, camera.height // SUPERSAMPLING
    return Picture(title, uri, width, height, round(np.degrees(azimuth), 3), round(np.degrees(elevation), 3))


def drawn(mesh: Mesh) -> Mesh:
    """The mesh as it is drawn, with fewer triangles where it has very many."""
    return simplified(mesh, DRAWN)


def viewing(
    name: str, mesh: Mesh, deviation: Deviation, colours: Colours
) -> tuple[dict[str, object], list[tuple[str, str]]]:
    """Settings of the view in 3D, and the packed scene by its element's id."""

    def levels_at(places: Points) -> Levels:
        return colours.levels(deviation.at(places))[:, None]

    frame, camera = cube_frame(mesh), Camera.around(mesh.corners.reshape(-1, 3), NARROW)
    slim = packing.slim(mesh, packing.TRIANGLES, packing.SHAPE, levels_at)
    made: Scene = packing.scene(slim.mesh, frame, slim.levels[:, 0])
    scenes: list[tuple[str, str]] = []
    target = as_tuple(frame.to_unit(camera.centre[None])[0])
    extent = camera.width / camera.scale / frame.scale
    deviating = f"{name}: deviation of the points, in {colours.unit}; grey-violet where no point is near"
    part = {
        "name": name,
        **placed(target, extent, (camera.width, camera.height)),
        "ticks": [list(tick) for tick in colours.ticks()],
        "truth": None,
        "meshes": [
            {
                "name": name,
                "scene": scene_settings("scene-0-0", made, scenes),
                "missed": None,
                "captions": {"shaded": name, "error": deviating},
            }
        ],
    }
    return settings_of([part], colours.palette, MODES, "error", unknown=True, lights=EVEN), scenes

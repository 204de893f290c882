"""The picture of a result: the points beside the shaded mesh, seen by one camera. No display, no OpenGL."""

from pathlib import Path

import numpy as np
from jaxtyping import Float64
from PIL import Image, ImageDraw, ImageFont

from weingarten.atomic import check_writable, replacing
from weingarten.errors import OutputError
from weingarten.mesh import Mesh
from weingarten.report.camera import SUPERSAMPLING, Camera
from weingarten.report.panel import Pixels, reduced, seen

Points = Float64[np.ndarray, "n 3"]

PANEL = 900
CAPTION = 64
NEAR_INK, FAR_INK = np.array([0.13, 0.27, 0.45]), np.array([0.80, 0.86, 0.92])
TEXT = (70, 78, 88)
FORMATS = (".png", ".jpg", ".jpeg", ".webp")
BLOCK = 200_000
"""Points drawn at once."""


def picture(
    points: Points, mesh: Mesh, names: tuple[str, str] = ("Scan", "Mesh"), panel: int = PANEL
) -> Image.Image:
    """The points (left) and the mesh (right), both in one frame, with `names` and counts beneath.

    Points are darker the nearer they are. Surfaces seen from inside, through a hole or because faces are
    turned, are terracotta. RGB, 2 × panel pixels wide, at most panel + 64 high.

    Raises OutputError when there are neither points nor triangles.
    """
    everything = np.concatenate([points, mesh.corners.reshape(-1, 3)])
    if not len(everything):
        raise OutputError("There is nothing to draw: neither points nor triangles.")
    camera = Camera.around(everything, panel)
    height = camera.height // SUPERSAMPLING
    sheet = Image.new("RGB", (2 * panel, height + CAPTION), "white")
    sheet.paste(reduced(drawn_points(points, camera)), (0, 0))
    sheet.paste(reduced(seen(mesh, camera).shaded()), (panel, 0))
    counts = (f"{len(points):,} points", f"{len(mesh.faces):,} triangles")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(size=22)
    for side, (name, count) in enumerate(zip(names, counts, strict=True)):
        middle = (side * panel + panel // 2, height + CAPTION // 3)
        pen.text(middle, f"{name}  ·  {count}", fill=TEXT, font=font, anchor="mm")
    return sheet


def check_picture_path(path: Path) -> None:
    """Raise OutputError unless a picture can be written to `path`."""
    check_picture_format(path)
    check_writable(path)


def check_picture_format(path: Path) -> None:
    """Raise OutputError unless the extension is a picture's."""
    if path.suffix.lower() not in FORMATS:
        raise OutputError(f"{path} names no picture format; end it in one of {', '.join(FORMATS)}.")


def write_picture(path: Path, points: Points, mesh: Mesh, names: tuple[str, str] = ("Scan", "Mesh")) -> None:
    """Write `picture` to a PNG, JPEG or WebP file. Raises OutputError."""
    check_picture_path(path)
    image = picture(points, mesh, names)
    with replacing(path) as temporary:
        image.save(temporary)


def drawn_points(points: Points, camera: Camera) -> Pixels:
    """Small discs on white, the nearer above the farther; ink fades with depth."""
    image = np.ones((camera.height, camera.width, 3))
    screen = camera.to_screen(points)
    depth = screen[:, 2]
    span = float(np.ptp(depth)) if len(depth) else 0.0
    near = (depth - depth.min(initial=np.inf)) / span if span > 0 else np.ones(len(depth))
    radius = camera.width / PANEL * float(np.clip(1.4 * np.sqrt(30_000 / max(len(points), 1)), 0.75, 4.0))
    reach = int(np.ceil(radius))
    steps = np.arange(-reach, reach + 1)
    across, down = (grid.reshape(-1) for grid in np.meshgrid(steps, steps))
    disc = across**2 + down**2 <= radius**2
    order = np.argsort(depth, kind="stable")
    foremost = np.full(camera.height * camera.width, -1)
    for start in range(0, len(order), BLOCK):
        middle = np.floor(screen[order[start : start + BLOCK], :2]).astype(np.int64)
        columns, rows = middle[:, :1] + across[disc], middle[:, 1:] + down[disc]
        inside = (rows >= 0) & (rows < camera.height) & (columns >= 0) & (columns < camera.width)
        rank = np.broadcast_to(np.arange(start, start + len(middle))[:, None], rows.shape)
        np.maximum.at(foremost, (rows * camera.width + columns)[inside], rank[inside])
    hit = foremost >= 0
    fading = near[order[foremost[hit]], None] ** 1.3
    image.reshape(-1, 3)[hit] = FAR_INK + (NEAR_INK - FAR_INK) * fading
    return image

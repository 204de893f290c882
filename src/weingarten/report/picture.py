"""The picture of a result: the points beside the shaded mesh, seen by one camera. No display, no OpenGL.

View frame: x right, y up, z towards the viewer; parallel projection, as in an engineering drawing.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64
from PIL import Image, ImageDraw, ImageFont

from weingarten.atomic import check_writable, replacing
from weingarten.errors import OutputError
from weingarten.mesh import Mesh
from weingarten.report.rasteriser import EMPTY, rasterise
from weingarten.report.shading import corner_normals, shade

Points = Float64[np.ndarray, "n 3"]
Pixels = Float64[np.ndarray, "height width 3"]

PANEL = 900
CAPTION = 64
MARGIN = 0.06
SUPERSAMPLING = 2
AZIMUTH, ELEVATION = np.radians(-58.0), np.radians(30.0)
NEAR_INK, FAR_INK = np.array([0.13, 0.27, 0.45]), np.array([0.80, 0.86, 0.92])
TEXT = (70, 78, 88)
FORMATS = (".png", ".jpg", ".jpeg", ".webp")
BLOCK = 200_000
"""Points drawn at once."""


@dataclass(frozen=True)
class Camera:
    """A three-quarter view: screen pixel = axes · (p − centre) × scale, y turned down, plus half the panel.

    width, height: of the panel, in supersampled pixels.
    """

    axes: Float64[np.ndarray, "3 3"]
    centre: Float64[np.ndarray, " 3"]
    scale: float
    width: int
    height: int

    @classmethod
    def around(cls, points: Points, panel: int) -> "Camera":
        """The camera that fits all points into a panel of that width, the lower the flatter they look."""
        size = panel * SUPERSAMPLING
        back = np.array(
            [np.cos(ELEVATION) * np.cos(AZIMUTH), np.cos(ELEVATION) * np.sin(AZIMUTH), np.sin(ELEVATION)]
        )
        right = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
        axes = np.stack([right, np.cross(back, right), back])
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        view = (points - middle) @ axes.T
        low, high = view.min(axis=0), view.max(axis=0)
        across, up = (high - low)[:2]
        extent = float(max(across, up))
        scale = size * (1 - 2 * MARGIN) / extent if extent > 0 else 1.0
        filled = int(np.ceil((scale * up + 2 * MARGIN * size) / SUPERSAMPLING)) * SUPERSAMPLING
        height = min(size, max(filled, size // 3))
        return cls(axes, middle + axes.T @ ((low + high) / 2), scale, size, height)

    def to_screen(self, points: Float64[np.ndarray, "*any 3"]) -> Float64[np.ndarray, "*any 3"]:
        """World positions to pixels right and down, and depth towards the viewer in pixels."""
        view = (points - self.centre) @ self.axes.T * (self.scale * np.array([1.0, -1.0, 1.0]))
        return view + np.array([self.width / 2, self.height / 2, 0.0])


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
    sheet.paste(_reduced(_drawn_points(points, camera)), (0, 0))
    sheet.paste(_reduced(_drawn_mesh(mesh, camera)), (panel, 0))
    counts = (f"{len(points):,} points", f"{len(mesh.faces):,} triangles")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(size=22)
    for side, (name, count) in enumerate(zip(names, counts, strict=True)):
        middle = (side * panel + panel // 2, height + CAPTION // 3)
        pen.text(middle, f"{name}  ·  {count}", fill=TEXT, font=font, anchor="mm")
    return sheet


def check_picture_path(path: Path) -> None:
    """Raise OutputError unless a picture can be written to `path`."""
    if path.suffix.lower() not in FORMATS:
        raise OutputError(f"{path} names no picture format; end it in one of {', '.join(FORMATS)}.")
    check_writable(path)


def write_picture(path: Path, points: Points, mesh: Mesh, names: tuple[str, str] = ("Scan", "Mesh")) -> None:
    """Write `picture` to a PNG, JPEG or WebP file. Raises OutputError."""
    check_picture_path(path)
    image = picture(points, mesh, names)
    with replacing(path) as temporary:
        image.save(temporary)


def _drawn_points(points: Points, camera: Camera) -> Pixels:
    """Small discs, the nearer above the farther; ink fades with depth."""
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


def _drawn_mesh(mesh: Mesh, camera: Camera) -> Pixels:
    """The shaded surface, with a thin line where depth jumps or the surface creases."""
    image = np.ones((camera.height, camera.width, 3))
    screen = camera.to_screen(mesh.corners)
    raster = rasterise(screen, camera.height, camera.width)
    hit = raster.face != EMPTY
    normals = np.zeros_like(image)
    rows, columns = np.nonzero(hit)
    face = raster.face[hit]
    weights = _barycentric(screen[face], np.stack([columns, rows], axis=1) + 0.5)
    normal = np.einsum("nk,nki->ni", weights, corner_normals(mesh)[face]) @ camera.axes.T
    normals[hit] = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    image[hit] = np.clip(shade(normals[hit]), 0.0, 1.0)
    return image * (1 - 0.45 * _lines(raster.depth, normals)[:, :, None])


def _barycentric(
    corners: Float64[np.ndarray, "n 3 3"], position: Float64[np.ndarray, "n 2"]
) -> Float64[np.ndarray, "n 3"]:
    a, b, c = corners[:, 0, :2], corners[:, 1, :2], corners[:, 2, :2]
    one, two, to = b - a, c - a, position - a
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    area = np.where(np.abs(area) < 1e-12, 1.0, area)
    u = (to[:, 0] * two[:, 1] - to[:, 1] * two[:, 0]) / area
    v = (one[:, 0] * to[:, 1] - one[:, 1] * to[:, 0]) / area
    weights = np.clip(np.stack([1 - u - v, u, v], axis=1), 0.0, 1.0)
    return weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-12)


def _lines(
    depth: Float64[np.ndarray, "height width"], normals: Pixels
) -> Float64[np.ndarray, "height width"]:
    """1 on the nearer side of a depth jump, less on a crease, 0 elsewhere."""
    strength = np.zeros(depth.shape)
    facing = np.maximum(np.abs(normals[:, :, 2]), 0.15)
    allowed = 4.0 / facing + 0.01 * depth.shape[1]
    solid = np.isfinite(depth)
    for axis, shift in ((0, 1), (0, -1), (1, 1), (1, -1)):
        other = np.roll(depth, shift, axis=axis)
        with np.errstate(invalid="ignore"):
            jump = solid & (depth - other > allowed)
        turn = np.einsum("hwi,hwi->hw", normals, np.roll(normals, shift, axis=axis))
        crease = solid & np.isfinite(other) & (turn < 0.8) & ~jump
        strength = np.maximum(strength, np.where(jump, 1.0, np.where(crease, 0.45, 0.0)))
    return strength


def _reduced(image: Pixels) -> Image.Image:
    """Supersampled values to one 8-bit panel: the mean of each block."""
    k = SUPERSAMPLING
    height, width, _ = image.shape
    mean = image.reshape(height // k, k, width // k, k, 3).mean(axis=(1, 3))
    return Image.fromarray(np.round(255 * np.clip(mean, 0.0, 1.0)).astype(np.uint8))

"""A mesh as one camera sees it, pixel by pixel: shaded, or coloured by whatever is known of every place.

"Seen" pixels are those that the mesh covers, row by row; all arrays of n rows are of them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64, Int64
from PIL import Image

from weingarten.mesh import Mesh
from weingarten.report.camera import SUPERSAMPLING, Camera
from weingarten.report.rasteriser import EMPTY, rasterise
from weingarten.report.shading import LIGHTS, Lights, brightness, corner_normals, shade

Pixels = Float64[np.ndarray, "height width 3"]
Rows = Float64[np.ndarray, "n 3"]

SHADE, TINT = 0.30, 0.74
"""Of a coloured surface: how much is the colour's own and how much takes part in light and shade."""


@dataclass(frozen=True)
class Panel:
    """What is seen of a mesh at every supersampled pixel of a camera's panel.

    seen: where the mesh is. face: the foremost face there. weights: barycentric, at the pixel's centre.
    normals: in the view frame, zero where nothing is seen. depth: in pixels, −inf there.
    """

    mesh: Mesh
    camera: Camera
    seen: Bool[np.ndarray, "height width"]
    face: Int64[np.ndarray, " n"]
    weights: Rows
    normals: Pixels
    depth: Float64[np.ndarray, "height width"]

    @cached_property
    def positions(self) -> Rows:
        """World positions of the seen places."""
        return np.einsum("nk,nki->ni", self.weights, self.mesh.corners[self.face])

    def shaded(self) -> Pixels:
        """The surface in the colours of `shade`, on white."""
        return self._lined(np.clip(shade(self.normals[self.seen]), 0.0, 1.0))

    def coloured(self, colours: Rows, lights: Lights = LIGHTS) -> Pixels:
        """The surface in the given colours, in light and shade, on white; both sides alike."""
        light = brightness(self.normals[self.seen], lights)[:, None]
        return self._lined(np.clip(colours * (SHADE + TINT * light), 0.0, 1.0))

    def _lined(self, colours: Rows) -> Pixels:
        image = np.ones((*self.seen.shape, 3))
        image[self.seen] = colours
        return image * (1 - 0.45 * _lines(self.depth, self.normals)[:, :, None])


def seen(mesh: Mesh, camera: Camera) -> Panel:
    """The mesh as the camera sees it; what is beside the panel is cut off."""
    screen = camera.to_screen(mesh.corners)
    raster = rasterise(screen, camera.height, camera.width)
    hit = raster.face != EMPTY
    normals = np.zeros((*hit.shape, 3))
    rows, columns = np.nonzero(hit)
    face = raster.face[hit]
    weights = _barycentric(screen[face], np.stack([columns, rows], axis=1) + 0.5)
    normal = np.einsum("nk,nki->ni", weights, corner_normals(mesh)[face]) @ camera.axes.T
    normals[hit] = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    return Panel(mesh, camera, hit, face, weights, normals, raster.depth)


def reduced(image: Pixels) -> Image.Image:
    """Supersampled values to one 8-bit panel: the mean of each block."""
    return Image.fromarray(_bytes(_blocks(image).mean(axis=(1, 3))))


def cut_out(image: Pixels, seen: Bool[np.ndarray, "height width"]) -> Image.Image:
    """The same without the background: every block is as opaque as it is seen. RGBA."""
    cover = _blocks(seen[:, :, None].astype(np.float64))
    colour = (_blocks(image) * cover).sum(axis=(1, 3))
    count = cover.sum(axis=(1, 3))
    rgb = np.divide(colour, count, out=np.ones_like(colour), where=count > 0)
    return Image.fromarray(_bytes(np.concatenate([rgb, count / SUPERSAMPLING**2], axis=2)))


def _blocks(image: Float64[np.ndarray, "height width k"]) -> Float64[np.ndarray, "rows s columns s k"]:
    k = SUPERSAMPLING
    height, width, channels = image.shape
    return image.reshape(height // k, k, width // k, k, channels)


def _bytes(values: Float64[np.ndarray, "*any"]) -> np.ndarray:
    return np.round(255 * np.clip(values, 0.0, 1.0)).astype(np.uint8)


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

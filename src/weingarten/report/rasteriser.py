"""Triangles to pixels without a display: scan conversion and a depth buffer, all triangles at once.

Screen frame: x to the right, y down, z towards the viewer, in pixels; the centre of pixel (row, column) is
(column + ½, row + ½). A pixel belongs to a triangle when its centre lies inside. An edge's crossing of a
row is computed from the same two end points in the same order for both triangles that share it, and spans
are half open: neighbours leave no hole between them and never paint a pixel twice.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

CHUNK = 2_000_000
EMPTY = -1


@dataclass(frozen=True)
class Raster:
    """What is seen at every pixel.

    face: index of the foremost triangle, EMPTY where there is none.
    depth: its z there, −inf where there is none.
    """

    face: Int64[np.ndarray, "height width"]
    depth: Float64[np.ndarray, "height width"]


def rasterise(corners: Float64[np.ndarray, "f 3 3"], height: int, width: int) -> Raster:
    """The foremost triangle of every pixel; corners in the screen frame. Work grows with covered pixels."""
    depth = np.full(height * width, -np.inf)
    face = np.full(height * width, EMPTY, dtype=np.int64)
    owner, row, start, stop = _spans(corners, height, width)
    gradient, offset = _depth_planes(corners)
    ends = np.cumsum(stop - start)
    total = int(ends[-1]) if len(ends) else 0
    cuts = np.searchsorted(ends, np.arange(CHUNK, total + CHUNK, CHUNK), side="left") + 1
    previous = 0
    for cut in np.unique(np.minimum(cuts, len(ends))):
        part = slice(previous, int(cut))
        length = stop[part] - start[part]
        which = np.repeat(owner[part], length)
        y = np.repeat(row[part], length)
        first = np.repeat(start[part] - (np.cumsum(length) - length), length)
        x = first + np.arange(len(first))
        z = offset[which] + gradient[which, 0] * (x + 0.5) + gradient[which, 1] * (y + 0.5)
        pixel = y * width + x
        np.maximum.at(depth, pixel, z)
        front = z >= depth[pixel]
        face[pixel[front]] = which[front]
        previous = int(cut)
    return Raster(face.reshape(height, width), depth.reshape(height, width))


def _spans(
    corners: Float64[np.ndarray, "f 3 3"], height: int, width: int
) -> tuple[
    Int64[np.ndarray, " s"], Int64[np.ndarray, " s"], Int64[np.ndarray, " s"], Int64[np.ndarray, " s"]
]:
    """Triangle, row, first column and one past the last column of every non-empty span on the screen."""
    low = np.clip(np.ceil(corners[:, :, 1].min(axis=1) - 0.5), 0, height).astype(np.int64)
    high = np.clip(np.ceil(corners[:, :, 1].max(axis=1) - 0.5), 0, height).astype(np.int64)
    rows = high - low
    owner = np.repeat(np.arange(len(corners)), rows)
    row = np.arange(len(owner)) - np.repeat(np.cumsum(rows) - rows - low, rows)
    left, right = np.full(len(owner), np.inf), np.full(len(owner), -np.inf)
    centre = row + 0.5
    for k in range(3):
        one, two = corners[:, k, :2], corners[:, (k + 1) % 3, :2]
        swap = (one[:, 1] > two[:, 1]) | ((one[:, 1] == two[:, 1]) & (one[:, 0] > two[:, 0]))
        bottom, top = np.where(swap[:, None], two, one), np.where(swap[:, None], one, two)
        rise = top[:, 1] - bottom[:, 1]
        slope = np.divide(top[:, 0] - bottom[:, 0], rise, out=np.zeros_like(rise), where=rise > 0)
        crossed = (bottom[owner, 1] <= centre) & (centre < top[owner, 1])
        x = bottom[owner, 0] + (centre - bottom[owner, 1]) * slope[owner]
        left = np.where(crossed, np.minimum(left, x), left)
        right = np.where(crossed, np.maximum(right, x), right)
    start = np.ceil(np.clip(left, -1, width + 1) - 0.5).astype(np.int64).clip(0, width)
    stop = np.ceil(np.clip(right, -1, width + 1) - 0.5).astype(np.int64).clip(0, width)
    kept = stop > start
    return owner[kept], row[kept], start[kept], stop[kept]


def _depth_planes(
    corners: Float64[np.ndarray, "f 3 3"],
) -> tuple[Float64[np.ndarray, "f 2"], Float64[np.ndarray, " f"]]:
    """g and o of z = o + g · (x, y) in the plane of every triangle; its mean depth where seen edge-on."""
    a, b, c = corners.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    seen = np.abs(normal[:, 2:]) > 1e-9 * np.linalg.norm(normal, axis=1, keepdims=True)
    gradient = np.divide(-normal[:, :2], normal[:, 2:], out=np.zeros_like(normal[:, :2]), where=seen)
    middle = (a + b + c) / 3
    return gradient, middle[:, 2] - np.einsum("fi,fi->f", gradient, middle[:, :2])

"""Point clouds to files: PLY (binary doubles), XYZ and TXT, CSV, NPY; coordinates to the last digit."""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from weingarten.atomic import check_writable, replacing
from weingarten.errors import OutputError

Points = Float64[np.ndarray, "n 3"]

SEPARATORS = {".xyz": " ", ".txt": " ", ".csv": ","}
FORMATS = (".ply", *SEPARATORS, ".npy")
BLOCK = 100_000
"""Points that are turned into text at once."""


def check_cloud_path(path: Path) -> None:
    """Raise OutputError unless a cloud can be written to `path`; ask before long work, not after it."""
    if path.suffix.lower() not in FORMATS:
        raise OutputError(
            f"{path} names no point-cloud format that can be written; end it in one of {', '.join(FORMATS)}."
        )
    check_writable(path)


def write_cloud(path: Path, points: Points) -> None:
    """Write the points in their own frame and unit; the extension picks the format, in either case.

    PLY: binary little-endian, x y z as doubles. XYZ, TXT, CSV: a point a line, no header, the shortest
    digits that read back as the same double. NPY: the (n, 3) float64 array. Raises OutputError.
    """
    check_cloud_path(path)
    suffix = path.suffix.lower()
    points = np.ascontiguousarray(points, dtype=np.float64)
    with replacing(path) as temporary:
        if suffix == ".ply":
            with temporary.open("wb") as stream:
                stream.write(_ply_header(len(points)))
                points.astype("<f8", copy=False).tofile(stream)
        elif suffix == ".npy":
            with temporary.open("wb") as stream:
                np.save(stream, points)
        else:
            with temporary.open("w", encoding="ascii", newline="\n") as stream:
                for start in range(0, len(points), BLOCK):
                    stream.write(_rows(points[start : start + BLOCK], SEPARATORS[suffix]))


def _rows(points: Points, separator: str) -> str:
    """A line for each point."""
    return "".join(separator.join(map(repr, point)) + "\n" for point in points.tolist())


def _ply_header(count: int) -> bytes:
    axes = "".join(f"property double {axis}\n" for axis in "xyz")
    text = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{axes}end_header\n"
    return text.encode("ascii")

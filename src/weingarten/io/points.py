"""Point clouds from files, in the file's own coordinates and with every digit that it holds."""

from collections.abc import Callable
from os import PathLike
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from weingarten.io.arrays import read_npy, read_npz
from weingarten.io.obj import read_obj
from weingarten.io.pcd import read_pcd
from weingarten.io.ply import read_ply
from weingarten.io.reading import check_readable, reading
from weingarten.io.stl import read_stl
from weingarten.io.text import read_text

Points = Float64[np.ndarray, "n 3"]

POINT_READERS: dict[str, Callable[[Path], Points]] = {
    ".ply": read_ply,
    ".xyz": read_text,
    ".txt": read_text,
    ".csv": read_text,
    ".obj": read_obj,
    ".stl": read_stl,
    ".npy": read_npy,
    ".npz": read_npz,
    ".pcd": read_pcd,
}


def read_points(path: str | PathLike[str]) -> Points:
    """The points of a file, (n, 3) in world units; the extension tells the format (POINT_READERS).

    Normals, colours and faces are ignored. Rows that are not finite are kept: `scan.diagnose` judges them.
    Raises InputError when the file is missing, empty, of an unknown extension, malformed or truncated.
    """
    path = Path(path)
    check_readable(path, POINT_READERS)
    with reading(path):
        points = POINT_READERS[path.suffix.lower()](path)
        if len(points) == 0:
            raise ValueError("it holds no points")
        return np.ascontiguousarray(points, dtype=np.float64)

"""NumPy's own files, NPY and NPZ. Pickles are never loaded, and headers are checked before use."""

from pathlib import Path
from zipfile import ZipFile

import numpy as np
from jaxtyping import Float64
from numpy.lib import format as npy

from weingarten.io.archive import checked_members
from weingarten.io.npy_header import checked_header

Points = Float64[np.ndarray, "n 3"]


def read_npy(path: Path) -> Points:
    """The first three columns of an (n, ≥3) array; ValueError for another shape, objects, truncation."""
    with path.open("rb") as stream:
        checked_header(stream, path.stat().st_size)
    return _positions(npy.open_memmap(path, mode="r"), "its array")


def read_npz(path: Path) -> Points:
    """The array `points`, (n, ≥3), or else the only (n, 3) array; ValueError when neither is there."""
    with ZipFile(path) as archive:
        headers = {}
        for member in checked_members(archive, path):
            if member.filename.endswith(".npy"):
                with archive.open(member) as stream:
                    headers[member.filename] = checked_header(stream, member.file_size)
        name = _name_of_points(headers)
        with archive.open(name) as stream:
            array = npy.read_array(stream, allow_pickle=False)
    return _positions(array, f"its array {name.removesuffix('.npy')}")


def _name_of_points(headers: dict[str, tuple[tuple[int, ...], np.dtype]]) -> str:
    """Which member to read."""
    if "points.npy" in headers:
        return "points.npy"
    fitting = [name for name, (shape, _) in headers.items() if len(shape) == 2 and shape[1] == 3]
    if len(fitting) != 1:
        names = ", ".join(name.removesuffix(".npy") for name in headers) or "none"
        raise ValueError(f"it needs an array named points or a single one of shape (n, 3), and has {names}")
    return fitting[0]


def _positions(array: np.ndarray, what: str) -> Points:
    """The first three columns as float64."""
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{what} holds {array.dtype} instead of real numbers")
    if array.ndim != 2 or array.shape[1] < 3:
        raise ValueError(f"{what} has shape {array.shape} instead of (n, 3)")
    return np.array(array[:, :3], dtype=np.float64)

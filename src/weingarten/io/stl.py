"""STL, ascii and binary: a soup of triangles, in which only equal coordinates tell which corners meet."""

import re
import struct
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from weingarten.io.coincident import coincident
from weingarten.io.text import table
from weingarten.mesh import Mesh

Points = Float64[np.ndarray, "n 3"]

_HEADER = 84
_FACET = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(r"^[ \t]*vertex[ \t]+([^\n]+)", re.MULTILINE | re.IGNORECASE)
_END = re.compile(r"^[ \t]*endfacet", re.MULTILINE | re.IGNORECASE)
_MOST_ROUNDING = 1e-5


def stl_corners(path: Path) -> Float64[np.ndarray, "f 3 3"]:
    """The corners of every triangle; ValueError for a malformed or truncated file."""
    size = path.stat().st_size
    with path.open("rb") as stream:
        head = stream.read(_HEADER)
    facets = struct.unpack("<I", head[80:])[0] if len(head) == _HEADER else 0
    fits = facets > 0 and _HEADER + facets * _FACET.itemsize <= size
    exact = _HEADER + facets * _FACET.itemsize == size
    if head.lstrip().lower().startswith(b"solid") and not exact:
        return _ascii_corners(path)
    if not fits:
        held = max(0, size - _HEADER) // _FACET.itemsize
        raise ValueError(f"its header promises {facets} triangles and it holds {held}")
    return np.fromfile(path, _FACET, facets, offset=_HEADER)["corners"].astype(np.float64)


def read_stl(path: Path) -> Points:
    """The distinct corners, in the order in which the file first names them."""
    corners = stl_corners(path).reshape(-1, 3)
    first, _ = coincident(corners)
    return corners[first]


def write_stl(path: Path, mesh: Mesh) -> tuple[str, ...]:
    """Write binary STL, or ascii where single precision would harm the mesh; a note then says so.

    Harm: a coordinate moves by more than 1e-5 of the bounding box's diagonal, or two vertices become one.
    """
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        single = mesh.vertices.astype(np.float32).astype(np.float64)
        rounding = float(np.abs(single - mesh.vertices).max() / np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    merges = len(coincident(single)[0]) < len(coincident(mesh.vertices)[0])
    if rounding <= _MOST_ROUNDING and not merges:
        _write_binary(path, mesh)
        return ()
    _write_ascii(path, mesh)
    harm = (
        "merge some vertices" if rounding <= _MOST_ROUNDING else f"move points by {rounding:.1e} of its size"
    )
    return (f"written as text with 17 digits, because binary STL's single precision would {harm}",)


def _ascii_corners(path: Path) -> Float64[np.ndarray, "f 3 3"]:
    with path.open(encoding="latin-1") as stream:
        text = stream.read()
    rows, ends = _VERTEX.findall(text), len(_END.findall(text))
    if not rows or len(rows) != 3 * ends:
        raise ValueError(f"it has {len(rows)} corners for {ends} triangles")
    return table(rows).reshape(-1, 3, 3)


def _unit_normals(mesh: Mesh) -> Float64[np.ndarray, "f 3"]:
    """Unit normals; zero for a triangle without area."""
    extent = float(np.ptp(mesh.vertices, axis=0).max()) or 1.0
    cross = Mesh((mesh.vertices - mesh.vertices[0]) / extent, mesh.faces).cross
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    return np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)


def _write_binary(path: Path, mesh: Mesh) -> None:
    facets = np.zeros(len(mesh.faces), dtype=_FACET)
    facets["normal"] = _unit_normals(mesh)
    facets["corners"] = mesh.corners
    with path.open("wb") as stream:
        # a header that began with the word solid would be taken for ascii
        stream.write(b"weingarten binary STL".ljust(80, b" "))
        stream.write(struct.pack("<I", len(facets)))
        stream.write(facets.tobytes())


def _write_ascii(path: Path, mesh: Mesh) -> None:
    vertices = [f"vertex {x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in mesh.vertices.tolist()]
    rows = zip(mesh.faces.tolist(), _unit_normals(mesh).tolist(), strict=True)
    with path.open("w", encoding="ascii", newline="\n") as stream:
        stream.write("solid weingarten\n")
        stream.writelines(
            f"facet normal {x:.6g} {y:.6g} {z:.6g}\nouter loop\n"
            f"{vertices[a]}{vertices[b]}{vertices[c]}endloop\nendfacet\n"
            for (a, b, c), (x, y, z) in rows
        )
        stream.write("endsolid weingarten\n")

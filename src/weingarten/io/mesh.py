"""Meshes from and to files, always in the file's own coordinates.

Every format comes back at the precision that its kind allows, at large offsets and at tiny sizes too:
see write_stl, write_ply, write_obj, write_glb and write_threemf for what each does about it.
"""

from collections.abc import Callable
from io import BytesIO
from os import PathLike
from pathlib import Path

import numpy as np
from jaxtyping import Int64

from weingarten.atomic import check_writable, replacing
from weingarten.errors import OutputError
from weingarten.extras import required
from weingarten.io.checked_glb import check_glb
from weingarten.io.checked_threemf import check_threemf
from weingarten.io.coincident import coincident
from weingarten.io.glb import write_glb
from weingarten.io.obj import write_obj
from weingarten.io.ply import write_ply
from weingarten.io.reading import check_readable, reading
from weingarten.io.stl import stl_corners, write_stl
from weingarten.io.threemf import write_threemf
from weingarten.mesh import Mesh

MESH_WRITERS: dict[str, Callable[[Path, Mesh], tuple[str, ...]]] = {
    ".stl": write_stl,
    ".ply": write_ply,
    ".obj": write_obj,
    ".glb": write_glb,
    ".3mf": write_threemf,
}


def read_mesh(path: str | PathLike[str]) -> Mesh:
    """The triangles of a file, in world units; the extension tells the format (MESH_READERS).

    Quads and polygons come as triangles, several bodies as one mesh. Vertices of exactly equal position
    are merged unless the faces are closed as the file has them (STL and shaded models repeat vertices).
    Raises InputError when the file is missing, malformed or has no faces; MissingExtraError for a 3MF
    without the extra `3mf`.
    """
    path = Path(path)
    check_readable(path, MESH_READERS)
    with reading(path):
        mesh = MESH_READERS[path.suffix.lower()](path)
        if len(mesh.faces) == 0:
            raise ValueError("it has no faces")
        if mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices):
            raise ValueError("a face names a vertex that is not there")
        if not np.isfinite(mesh.vertices).all():
            raise ValueError("some vertices are not finite")
        return mesh if _is_closed(mesh.faces) else _merged(mesh)


def write_mesh(path: str | PathLike[str], mesh: Mesh) -> tuple[str, ...]:
    """Write a mesh as what the extension says (MESH_WRITERS), whole or not at all; notes for the user.

    Raises OutputError when the file cannot be made, or the mesh is empty or not finite.
    """
    path = Path(path)
    check_mesh_path(path)
    if len(mesh.faces) == 0 or not np.isfinite(mesh.vertices).all():
        raise OutputError(f"{path} was not written, because the mesh is empty or not finite.")
    with replacing(path) as temporary:
        notes = MESH_WRITERS[path.suffix.lower()](temporary, mesh)
    return tuple(f"{path.name}: {note}." for note in notes)


def check_mesh_path(path: str | PathLike[str]) -> None:
    """Raise OutputError unless a mesh can be written at `path`; ask before long work, not after it."""
    path = Path(path)
    if path.suffix.lower() not in MESH_WRITERS:
        known = " ".join(sorted(MESH_WRITERS))
        raise OutputError(f"{path} has no mesh format that can be written; choose one of {known}.")
    check_writable(path)


def _is_closed(faces: Int64[np.ndarray, "f 3"]) -> bool:
    """Whether every directed edge has its opposite as often as it occurs itself."""
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    base = int(faces.max()) + 1
    return np.array_equal(np.sort(tails * base + heads), np.sort(heads * base + tails))


def _merged(mesh: Mesh) -> Mesh:
    first, inverse = coincident(mesh.vertices)
    return Mesh(mesh.vertices[first], inverse[mesh.faces])


def _read_stl(path: Path) -> Mesh:
    corners = stl_corners(path)
    return Mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def _read_3mf(path: Path) -> Mesh:
    for module in ("lxml", "networkx"):
        required(module, f"Reading {path} needs", "3mf")
    check_threemf(path)
    return _read_trimesh(path)


def _read_glb(path: Path) -> Mesh:
    check_glb(path)
    return _read_trimesh(path)


def _read_obj(path: Path) -> Mesh:
    return _read_trimesh(path, maintain_order=True)


def _read_trimesh(path: Path, **options: bool) -> Mesh:
    # a third of a second to import, which a fit need not spend
    import trimesh

    # given a path, trimesh would open whatever other files this one names; given bytes, it finds none, and
    # reads no more than there are, whatever the file announces
    content, kind = BytesIO(path.read_bytes()), path.suffix.lower().removeprefix(".")
    if kind in ("ply", "obj", "glb"):
        options["skip_materials"] = True
    # process=True would merge vertices nearer than 1e-8, a thousandth of a part of size 1e-5
    loaded = trimesh.load_mesh(content, file_type=kind, process=False, **options)
    if not isinstance(loaded, trimesh.Trimesh):
        raise ValueError("it has no faces")
    return Mesh(
        np.array(loaded.vertices, dtype=np.float64), np.array(loaded.faces, dtype=np.int64).reshape(-1, 3)
    )


MESH_READERS: dict[str, Callable[[Path], Mesh]] = {
    ".stl": _read_stl,
    ".ply": _read_trimesh,
    ".obj": _read_obj,
    ".off": _read_trimesh,
    ".glb": _read_glb,
    ".3mf": _read_3mf,
}

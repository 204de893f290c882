"""What a GLB would become in memory, counted before it is read: see `unfolding`."""

import json
import struct
from pathlib import Path
from typing import Any

from weingarten.io.unfolding import INSTANCE, check_unfolded

_HEADER = struct.Struct("<4sIIII")
_WIDTHS = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_POSITION, _INDEX = 24, 8
"""Bytes of a position and of an index in memory."""


def check_glb(path: Path) -> None:
    """Raise ValueError for a GLB that names other files or unfolds to far more than it is.

    Every accessor counts once with all that it announces, and every node that places a mesh with the mesh's
    positions and indices.
    """
    size = path.stat().st_size
    with path.open("rb") as stream:
        magic, _, _, length, _ = _HEADER.unpack(stream.read(_HEADER.size))
        if magic != b"glTF" or length > size:
            raise ValueError("it does not start as binary glTF does")
        document = json.loads(stream.read(length))
    for buffer in document.get("buffers", []):
        if not buffer.get("uri", "data:").startswith("data:"):
            raise ValueError("it refers to another file")
    accessors = document.get("accessors", [])
    counts = [_count(accessor) for accessor in accessors]
    unfolded = sum(
        count * _WIDTHS[accessor["componentType"]] * _COMPONENTS[accessor["type"]]
        for count, accessor in zip(counts, accessors, strict=True)
    )
    meshes = [_mesh_size(mesh, counts) for mesh in document.get("meshes", [])]
    unfolded += sum(meshes)
    for node in document.get("nodes", []):
        places = INSTANCE * (1 + len(node.get("children", [])))
        unfolded += places + (meshes[node["mesh"]] if "mesh" in node else 0)
    check_unfolded(unfolded, size, "would unfold")


def _count(accessor: dict[str, Any]) -> int:
    """How many items an accessor announces; ValueError for what is no count."""
    count = accessor["count"]
    if not isinstance(count, int) or count < 0:
        raise ValueError(f"it counts {count} items")
    return count


def _mesh_size(mesh: dict[str, Any], counts: list[int]) -> int:
    """Bytes that a mesh takes up wherever it is placed."""
    sizes = []
    for primitive in mesh["primitives"]:
        corners = counts[primitive["attributes"]["POSITION"]]
        indices = counts[primitive["indices"]] if "indices" in primitive else corners
        sizes.append(INSTANCE + corners * _POSITION + indices * _INDEX)
    return sum(sizes)

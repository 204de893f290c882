"""Wavefront OBJ: the vertices of a file, and meshes written with every digit of their coordinates."""

import re
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from weingarten.io.text import table
from weingarten.mesh import Mesh

Points = Float64[np.ndarray, "n 3"]

_VERTEX = re.compile(r"^[ \t]*v[ \t]+([^\n#]+)", re.MULTILINE)


def read_obj(path: Path) -> Points:
    """The positions of all `v` lines; ValueError when there are none or one is not three numbers."""
    with path.open(encoding="latin-1") as stream:
        rows = _VERTEX.findall(stream.read())
    if not rows:
        raise ValueError("it has no vertex lines")
    return table(rows)


def write_obj(path: Path, mesh: Mesh) -> tuple[str, ...]:
    """Write the shortest digits that give back each double exactly. No notes."""
    with path.open("w", encoding="ascii", newline="\n") as stream:
        stream.write("# weingarten\n")
        stream.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist())
        stream.writelines(f"f {a} {b} {c}\n" for a, b, c in (mesh.faces + 1).tolist())
    return ()

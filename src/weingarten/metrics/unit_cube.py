"""The unit cube that protocols measure in: a mesh's box with its centre at the origin, its longest side 1."""

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.mesh import Mesh


def used_box(mesh: Mesh) -> Float64[np.ndarray, "2 3"]:
    """Lowest and highest corner of the box of the vertices which faces use; there is at least one face."""
    used = np.zeros(len(mesh.vertices), dtype=bool)
    used[mesh.faces] = True
    x, y, z = mesh.vertices.T
    return np.array([[axis.min(), axis.max()] for axis in (x[used], y[used], z[used])]).T


def cube_frame(mesh: Mesh) -> Frame:
    """The frame whose unit is the longest side of the mesh's box, about the centre of that box.

    The box must have a finite extent, as `weingarten.metrics.findings.check_surface` makes sure.
    """
    lowest, highest = used_box(mesh)
    x, y, z = ((lowest + highest) / 2).tolist()
    return Frame((x, y, z), float((highest - lowest).max()))


def unit_cube(mesh: Mesh, reference: Mesh) -> Mesh:
    """The mesh moved and scaled as takes the reference's box into the unit cube."""
    return Mesh(cube_frame(reference).to_unit(mesh.vertices), mesh.faces)

"""What has to be known of two meshes before the figures of their comparison are read.

A mesh without a surface is an error. Anything else is measured as it is, and what limits the figures is
named: a `Finding` has a short name that stays, for programs, and a sentence for people.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from weingarten.errors import InputError
from weingarten.mesh import Mesh
from weingarten.metrics.topology import Topology
from weingarten.metrics.unit_cube import cube_frame, unit_cube, used_box

Role = Literal["mesh", "truth"]

SIZE_RATIO = 3.0
"""Boxes whose diagonals differ by more than this factor are hardly of one part in one unit."""

NO_VOLUME = 1e-12
"""A closed surface that encloses less, in cubes of its box's longest side, is a double sheet."""

NO_HEIGHT = 1e-12
"""A face that is lower, in longest sides of the box, is a line but for the rounding of its corners."""


@dataclass(frozen=True)
class Finding:
    """Something that limits what figures mean: a stable name, such as `truth-open`, and a sentence."""

    name: str
    sentence: str


def check_surface(mesh: Mesh, role: Role) -> None:
    """Raise InputError, naming the role, unless the mesh has a surface: finite faces, some with an area."""
    faces, used = mesh.faces, f"The {role}"
    if not len(faces):
        raise InputError(f"{used} has no faces, so there is no surface to compare.")
    if faces.min() < 0 or faces.max() >= len(mesh.vertices):
        raise InputError(f"{used} has a face that names a vertex which is not there; export it again.")
    if not np.isfinite(mesh.corners).all():
        raise InputError(f"{used} has vertices that are not finite; export it again.")
    scale = cube_frame(mesh).scale
    if not 0 < scale < np.inf:
        raise InputError(f"{used}'s bounding box has no finite extent, so there is no surface to compare.")
    if not (unit_cube(mesh, mesh).areas > 0).any():
        raise InputError(f"{used} has no face with an area, so there is no surface to compare.")


def has_inside(mesh: Mesh, shape: Topology) -> bool:
    """Whether the mesh parts space: closed, its faces agreeing on outside, and with a volume in between.

    shape: the mesh's topology, in the same frame.
    """
    return shape.watertight and shape.oriented and not _is_flat(mesh, shape)


def pair_findings(mesh: Mesh, mine: Topology, truth: Mesh, its: Topology) -> tuple[Finding, ...]:
    """What limits the figures of a mesh against the truth, in one frame; with the topology of each."""
    return (
        *surface_findings(truth, its, "truth"),
        *surface_findings(mesh, mine, "mesh"),
        *_box_findings(mesh, truth),
    )


def surface_findings(mesh: Mesh, shape: Topology, role: Role) -> tuple[Finding, ...]:
    """What limits the figures of one of the two meshes; `shape` is its topology, in the same frame."""
    found = []
    if not shape.watertight:
        found.append(("open", f"The {role} is not closed, so it has neither a volume nor an inside."))
    elif not shape.oriented:
        found.append(
            ("not-oriented", f"Faces of the {role} disagree on which side is outside, so it has no inside.")
        )
    elif _is_flat(mesh, shape):
        found.append(("no-volume", f"The {role} is closed but encloses no volume."))
    elif shape.volume < 0:
        found.append(
            (
                "inside-out",
                f"The {role} is inside out; what it encloses is taken for its inside all the same.",
            )
        )
    if shape.components > 1:
        found.append(("bodies", f"The {role} is not one surface but {shape.components:,} separate ones."))
    lines = _faces_without_height(mesh)
    if lines:
        sentence = f"{lines:,} of the {len(mesh.faces):,} faces of the {role} have no area and so no normal."
        found.append(("degenerate-faces", sentence))
    return tuple(Finding(f"{role}-{name}", sentence) for name, sentence in found)


def _is_flat(mesh: Mesh, shape: Topology) -> bool:
    return abs(shape.volume) <= NO_VOLUME * cube_frame(mesh).scale ** 3


def _faces_without_height(mesh: Mesh) -> int:
    a, b, c = mesh.corners.transpose(1, 0, 2)
    squares = [np.einsum("fi,fi->f", side, side) for side in (b - a, c - b, a - c)]
    longest = np.sqrt(np.maximum(np.maximum(squares[0], squares[1]), squares[2]))
    return int((2 * mesh.areas <= NO_HEIGHT * cube_frame(mesh).scale * longest).sum())


def _box_findings(mesh: Mesh, truth: Mesh) -> tuple[Finding, ...]:
    (low, high), (true_low, true_high) = used_box(mesh), used_box(truth)
    ratio = float(np.linalg.norm(high - low) / np.linalg.norm(true_high - true_low))
    found = []
    if not 1 / SIZE_RATIO <= ratio <= SIZE_RATIO:
        sentence = f"The mesh is {ratio:.3g} times as large as the truth; are both in the same unit?"
        found.append(Finding("size-mismatch", sentence))
    if (low > true_high).any() or (high < true_low).any():
        sentence = "The boxes of the mesh and the truth do not meet; are both in the same coordinates?"
        found.append(Finding("boxes-apart", sentence))
    return tuple(found)

"""Which primitive every vertex of a run's mesh belongs to, where `weingarten measure` has said so."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Int64, UInt8

from weingarten.fit.run_folder import LABELS, PRIMITIVES
from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest

FREE = -1

PAINTS = (
    "#4c78a8", "#f58518", "#54a24b", "#e45756", "#72b7b2", "#b279a2", "#eeca3b", "#9d755d", "#ff9da6",
    "#2f6b8f", "#c4722e", "#86bc5f", "#8c6bb1", "#d37295", "#499894", "#b6992d", "#a0cbe8", "#7b848f",
)  # fmt: skip
FREE_PAINT = "#d5d8dc"


@dataclass(frozen=True)
class Primitives:
    """labels: of every vertex of a mesh, FREE of those that are of none. names: by label."""

    labels: Int64[np.ndarray, " v"]
    names: tuple[str, ...]

    def paints(self, mesh: Mesh, other: Mesh) -> UInt8[np.ndarray, " f"]:
        """Of another mesh's faces: 0 of the free ones, k of the k-th of PAINTS. mesh: that of the labels.

        A face is of what most corners of the face nearest to its middle are of.
        """
        a, b, c = self.labels[mesh.faces[closest(mesh, other.corners.mean(axis=1)).face]].T
        label = np.where(b == c, b, a)
        return np.where(label == FREE, 0, 1 + label % len(PAINTS)).astype(np.uint8)

    def legend(self) -> list[tuple[int, str]]:
        """Paint and name of every primitive that has vertices, in the order of the table."""
        there = np.unique(self.labels[self.labels != FREE])
        return [(int(1 + k % len(PAINTS)), self.names[k]) for k in there]


def primitives_in(folder: Path, mesh: Mesh) -> Primitives | None:
    """What a run folder says of its mesh; None where it says nothing, or speaks of another mesh."""
    if not all((folder / name).is_file() for name in (LABELS, PRIMITIVES)):
        return None
    try:
        # mapped: a header that promises more than there is takes no memory
        labels = np.load(folder / LABELS, mmap_mode="r", allow_pickle=False)
        said = json.loads((folder / PRIMITIVES).read_text(encoding="utf-8"))
    except (OSError, ValueError, EOFError, RecursionError):
        return None
    rows = said.get("primitives") if isinstance(said, dict) else None
    if not isinstance(rows, list) or labels.shape != (len(mesh.vertices),) or labels.dtype.kind != "i":
        return None
    if labels.min(initial=0) < FREE or labels.max(initial=FREE) >= len(rows):
        return None
    return Primitives(labels.astype(np.int64), tuple(named(row, k) for k, row in enumerate(rows)))


def named(row: object, number: int) -> str:
    """A primitive's number, kind and, of holes, side, and its radius where it has one."""
    known = row if isinstance(row, dict) else {}
    words = [str(number), str(known.get("kind", "primitive"))]
    words += ["hole"] if known.get("side") == "hole" else []
    radius = known.get("radius")
    return " ".join(words) + (f", r {radius:.4g}" if isinstance(radius, float) else "")


def paint_map() -> list[int]:
    """256 colours, three bytes each, by paint."""
    codes = [FREE_PAINT, *PAINTS]
    rows = [[int(code[i : i + 2], 16) for i in (1, 3, 5)] for code in codes]
    return [channel for row in rows + [rows[0]] * (256 - len(rows)) for channel in row]

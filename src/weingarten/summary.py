"""What can be said of a result without a ground truth."""

from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from jaxtyping import Float64

from weingarten.mesh import Mesh
from weingarten.metrics.confidence import confidence
from weingarten.metrics.coverage import coverage
from weingarten.metrics.distance import closest
from weingarten.metrics.self_intersections import self_intersecting
from weingarten.metrics.topology import topology

Points = Float64[np.ndarray, "_ 3"]

MOST_POINTS = 200_000
"""Distances are taken from at most so many points, evenly picked from the cloud."""


def probe(points: Points) -> Points:
    """The points that distances are taken from."""
    return points[:: max(1, -(-len(points) // MOST_POINTS))]


def borne_out(mesh: Mesh, points: Points, noise: float) -> Mesh:
    """The mesh with its vertices' confidence; mesh, points and noise in one frame."""
    return replace(mesh, confidence=confidence(mesh.vertices, probe(points), noise))


@dataclass(frozen=True)
class Summary:
    """Quality and cost of a fit; lengths in the input's unit, times in seconds.

    points: of the cloud, after cleaning. distance_*: of cloud points to the mesh's triangles.
    guessed, missed: shares of the area far from all points, and of the points far from the mesh; doubts: what
    they say against the mesh, a sentence each (`weingarten.metrics.coverage`).
    genus: None where the mesh is not closed. self_intersecting: faces that pass through others.
    steps, of_steps: taken and planned.
    finished: False after an interruption. loss: of the last step, None when none was taken.
    """

    points: int
    vertices: int
    faces: int
    distance_mean: float
    distance_p95: float
    distance_max: float
    diagonal: float
    guessed: float
    missed: float
    watertight: bool
    components: int
    genus: int | None
    self_intersecting: int
    volume: float
    steps: int
    of_steps: int
    finished: bool
    loss: float | None
    seconds: dict[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return asdict(self) | {"notes": list(self.notes), "doubts": list(self.doubts)}


def summarise(
    points: Points,
    mesh: Mesh,
    noise: float,
    steps: int,
    of_steps: int,
    finished: bool,
    loss: float | None,
    seconds: dict[str, float],
    notes: tuple[str, ...],
) -> Summary:
    """The figures of a mesh in the frame of its cloud.

    noise: mean distance of the points from their surface, in the same unit.
    """
    probes = probe(points)
    distance = closest(mesh, probes).distance
    covered = coverage(mesh, probes, distance, noise)
    shape = topology(mesh)
    return Summary(
        points=len(points),
        vertices=len(mesh.vertices),
        faces=len(mesh.faces),
        distance_mean=float(distance.mean()),
        distance_p95=float(np.percentile(distance, 95)),
        distance_max=float(distance.max()),
        diagonal=float(np.linalg.norm(np.ptp(points, axis=0))),
        guessed=covered.guessed,
        missed=covered.missed,
        watertight=shape.watertight,
        components=shape.components,
        genus=shape.genus,
        self_intersecting=int(self_intersecting(mesh).sum()),
        volume=shape.volume,
        steps=steps,
        of_steps=of_steps,
        finished=finished,
        loss=loss,
        seconds=seconds,
        notes=notes,
        doubts=covered.doubts,
    )

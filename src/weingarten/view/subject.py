"""What is looked at: a mesh or a cloud that lies still, or a run (`weingarten.view.run`), which may move."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from weingarten.errors import InputError
from weingarten.fit.curve import Columns
from weingarten.frame import Frame
from weingarten.io.mesh import MESH_READERS, read_mesh
from weingarten.io.points import POINT_READERS, read_points
from weingarten.mesh import Mesh
from weingarten.scan.noise import noise_level
from weingarten.scan.thinning import thinned
from weingarten.view.primitives import Primitives
from weingarten.view.section import Box
from weingarten.view.status import Status
from weingarten.world_field import WorldField

Points = Float64[np.ndarray, "_ 3"]

FEWEST = 24
"""Points whose noise can be told."""


@dataclass(frozen=True)
class Surface:
    """mesh: world frame. field: whose zero set it is, if known. primitives: which vertex is of which."""

    mesh: Mesh
    field: WorldField | None = None
    primitives: Primitives | None = None


@dataclass(frozen=True)
class Look:
    """What there is at the moment.

    version: another one when all that was known is void. final: another one with every new mesh, empty
    without one. steps: those whose surface can be asked for. status: of a run. facts: sentences about it.
    """

    version: str = ""
    final: str = ""
    steps: tuple[int, ...] = ()
    status: Status | None = None
    curve: Columns = field(default_factory=dict)
    facts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Cloud:
    """points: those that are measured by, world frame; of very many a part. given: how many there are.

    noise: mean distance of the points from their surface, in their unit.
    """

    points: Points
    given: int
    noise: float

    @classmethod
    def of(cls, points: Points) -> "Cloud":
        """Rows that are not finite are left out. Raises InputError where no point is left."""
        finite = points[np.isfinite(points).all(axis=1)]
        if not len(finite):
            raise InputError("The cloud holds no point with three finite coordinates; export it again.")
        own = thinned(finite, 0)
        if len(own) < FEWEST:
            return cls(own, len(points), 0.0)
        frame = frame_of(own)
        unit = frame.to_unit(own)
        return cls(own, len(points), noise_level(unit, KDTree(unit)) * frame.scale)

    @classmethod
    def read(cls, path: Path) -> "Cloud":
        """Of a file. Raises InputError."""
        return cls.of(read_points(path))


@runtime_checkable
class Subject(Protocol):
    """Something to be looked at, in its own coordinates."""

    @property
    def name(self) -> str:
        """For people."""
        ...

    @property
    def frame(self) -> Frame:
        """Of everything that is drawn."""
        ...

    @property
    def cloud(self) -> Cloud | None:
        """The points, if there are any."""
        ...

    @property
    def box(self) -> Box | None:
        """Where the field may be cut; None without a field."""
        ...

    def look(self) -> Look:
        """What there is now; asked often, and never raises what will pass."""
        ...

    def surface(self, step: int | None) -> Surface:
        """The final surface, or that of a step. Raises a WeingartenError where there is none."""
        ...


@dataclass(frozen=True)
class Still:
    """A mesh, a cloud, or both, from files."""

    name: str
    mesh: Mesh | None
    cloud: Cloud | None
    box: Box | None = None

    @property
    def frame(self) -> Frame:
        """See Subject: that of the mesh, else of the points."""
        if self.mesh is not None:
            return frame_of(self.mesh.vertices)
        assert self.cloud is not None
        return frame_of(self.cloud.points)

    def look(self) -> Look:
        """See Subject."""
        return Look(final="" if self.mesh is None else "mesh")

    def surface(self, step: int | None) -> Surface:
        """See Subject."""
        if self.mesh is None or step is not None:
            raise InputError(f"{self.name} has no such mesh.")
        return Surface(self.mesh)


def still(path: Path, points: Path | None) -> Still:
    """A file's mesh, else its points; and those of another file. Raises InputError, MissingExtraError."""
    found = contents(path)
    mesh = found if isinstance(found, Mesh) else None
    other = None if points is None else read_points(points)
    own = found if other is None and not isinstance(found, Mesh) else other
    return Still(path.name, mesh, None if own is None else Cloud.of(own))


def contents(path: Path) -> Mesh | Points:
    """The mesh of a file, else its points. Raises InputError for what is neither."""
    kind = path.suffix.lower()
    if kind in POINT_READERS and kind not in MESH_READERS:
        return read_points(path)
    try:
        return read_mesh(path)
    except InputError:
        if kind not in POINT_READERS or not path.is_file():
            raise
        return read_points(path)


def frame_of(points: Points) -> Frame:
    """The frame of points, of which there may be but one."""
    frame = Frame.of(points)
    return frame if frame.scale > 0.0 else Frame(frame.centre, 1.0)

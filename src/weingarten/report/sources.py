"""The meshes that are shown of a part: its truth, and one of every contender; or why one is missing."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from weingarten.bench.job import DONE
from weingarten.bench.results import Result
from weingarten.bench.store import Store
from weingarten.errors import InputError
from weingarten.io.mesh import read_mesh
from weingarten.mesh import Mesh
from weingarten.metrics.findings import Role, check_surface


def shown_fits(found: Sequence[Result], part: str, names: Sequence[str]) -> list[Result]:
    """Of every contender its fit of this part with the least seed, if possible one that left a mesh."""
    chosen = []
    for name in names:
        own = sorted(
            (one for one in found if (one.part, one.contender) == (part, name)),
            key=lambda one: (not one.entry.mesh_path.exists(), one.seed),
        )
        chosen += own[:1]
    return chosen


def truth_of(store: Store, fits: Sequence[Result]) -> tuple[Mesh | None, str]:
    """The mesh that a part's fits were compared with, world frame; or None, and a sentence that says why."""
    paths = list(dict.fromkeys(one.fit["truth"] for one in fits if one.fit.get("truth")))
    if not paths:
        return None, "The records do not say where its truth is, so errors cannot be drawn."
    path = Path(paths[0])
    if not path.exists():
        return None, f"The truth, {path}, is no longer there, so errors cannot be drawn."
    kept = store.truth(fits[0].part).get("sha256")
    if kept is not None and hashlib.sha256(path.read_bytes()).hexdigest() != kept:
        return None, f"The truth, {path}, has changed since the fits were made, so errors cannot be drawn."
    try:
        return finite(surface(read_mesh(path), "truth")), ""
    except InputError as error:
        return None, f"{error} Errors cannot be drawn."


def mesh_of(one: Result) -> tuple[Mesh | None, str]:
    """A fit's mesh, world frame; or None, and a sentence that says why."""
    if one.fit.get("status") != DONE:
        return None, one.error
    try:
        mesh = read_mesh(one.entry.mesh_path)
        return finite(mesh if one.good else surface(mesh, "mesh")), ""  # whatever was judged has a surface
    except InputError as error:
        return None, str(error)


def surface(mesh: Mesh, role: Role) -> Mesh:
    """The mesh itself. Raises InputError unless it has a surface."""
    check_surface(mesh, role)
    return mesh


def finite(mesh: Mesh) -> Mesh:
    """The mesh without vertices that no face uses, where one of these is not finite."""
    if np.isfinite(mesh.vertices).all():
        return mesh
    used, inverse = np.unique(mesh.faces, return_inverse=True)
    return Mesh(mesh.vertices[used], inverse.reshape(-1, 3))

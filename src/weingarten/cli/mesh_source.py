"""A mesh named on the command line: a file, or a part that comes with the package."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from weingarten.mesh import Mesh

BUNDLED = "bundled:"
HELP = "mesh file, or bundled:flange, bundled:bracket, bundled:block"


def bundled_name(source: str) -> str | None:
    """The part's name in `bundled:NAME`; None for a file."""
    return source.removeprefix(BUNDLED) if source.startswith(BUNDLED) else None


def load(source: str) -> Mesh:
    """The mesh, in world units. Raises InputError for a file that cannot be read, OptionError for a part
    that does not exist."""
    name = bundled_name(source)
    if name is None:
        from weingarten.io.mesh import read_mesh

        return read_mesh(Path(source))
    from weingarten.samples.parts import part_mesh

    return part_mesh(name)

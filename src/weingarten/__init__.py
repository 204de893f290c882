"""Unoriented points of a CAD part in, a clean watertight mesh out.

    import weingarten as wg
    result = wg.reconstruct(wg.read_points("scan.ply"))
    wg.write_mesh("part.stl", result.mesh)

Every term of a loss is of use in any other training loop, with any module f: (n, 3) → (n,):

    from weingarten.terms.off_diagonal_weingarten import OFF_DIAGONAL_WEINGARTEN
    loss = loss + 10 * OFF_DIAGONAL_WEINGARTEN(model, points).mean()

Names are imported when first used, so that `import weingarten` costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from weingarten.io.mesh import read_mesh, write_mesh
    from weingarten.io.points import read_points
    from weingarten.measure.measurement import Measurement, measurement
    from weingarten.mesh import Mesh
    from weingarten.methods import METHODS
    from weingarten.metrics.protocol import PROTOCOLS
    from weingarten.reconstruction import Result, reconstruct
    from weingarten.settings import PRESETS, Settings, resolve
    from weingarten.together import reconstruct_many
    from weingarten.world_field import WorldField

HOME = {
    "METHODS": "methods",
    "PRESETS": "settings",
    "PROTOCOLS": "metrics.protocol",
    "Measurement": "measure.measurement",
    "Mesh": "mesh",
    "Result": "reconstruction",
    "Settings": "settings",
    "WorldField": "world_field",
    "measurement": "measure.measurement",
    "read_mesh": "io.mesh",
    "read_points": "io.points",
    "reconstruct": "reconstruction",
    "reconstruct_many": "together",
    "resolve": "settings",
    "write_mesh": "io.mesh",
}

__all__ = [
    "METHODS",
    "PRESETS",
    "PROTOCOLS",
    "Measurement",
    "Mesh",
    "Result",
    "Settings",
    "WorldField",
    "measurement",
    "read_mesh",
    "read_points",
    "reconstruct",
    "reconstruct_many",
    "resolve",
    "write_mesh",
]


def __getattr__(name: str) -> object:
    if name not in HOME:
        raise AttributeError(f"module 'weingarten' has no attribute {name!r}")
    return getattr(import_module(f"weingarten.{HOME[name]}"), name)

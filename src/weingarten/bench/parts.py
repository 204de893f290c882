"""The parts of a benchmark: a folder of true meshes, with or without a cloud beside each."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from weingarten.errors import InputError, OptionError
from weingarten.io.mesh import MESH_READERS, read_mesh
from weingarten.io.points import POINT_READERS, read_points
from weingarten.mesh import Mesh
from weingarten.scan.sampling import Points, sample_surface

CLOUD = ".cloud"
"""What stands between a part's name and its cloud's extension: bracket.stl, bracket.cloud.xyz."""


@dataclass(frozen=True)
class Part:
    """A true mesh, and its scan where there is one; else the scan is a sample of the mesh."""

    name: str
    truth: Path
    cloud: Path | None = None

    def mesh(self) -> Mesh:
        """The truth, world frame. Raises InputError."""
        return read_mesh(self.truth)

    def scan(self, count: int, seed: int) -> Points:
        """The part's cloud, else `count` points uniform by area on the truth. Raises InputError."""
        if self.cloud is not None:
            return read_points(self.cloud)
        return sample_surface(self.mesh(), count, seed)[0]


def parts_in(folder: Path, only: Sequence[str] = ()) -> list[Part]:
    """The parts of a folder by name; of `only` these names, where it has any.

    Every file NAME.EXT with a mesh's extension is a truth; NAME.cloud.EXT is the cloud of NAME.
    Raises InputError for a folder without meshes, two truths of one name or a cloud without its truth;
    OptionError for a name in `only` that is not there.
    """
    if not folder.is_dir():
        raise InputError(f"There is no folder {folder}; name one that holds true meshes.")
    files = sorted(path for path in folder.iterdir() if path.is_file() and not path.name.startswith("."))
    clouds = {
        cloud_name(path): path for path in files if cloud_name(path) and path.suffix.lower() in POINT_READERS
    }
    truths: dict[str, Path] = {}
    for path in files:
        if cloud_name(path) or path.suffix.lower() not in MESH_READERS:
            continue
        if path.stem in truths:
            raise InputError(
                f"{folder} has two meshes of {path.stem}, {truths[path.stem].name} and {path.name}; keep one."
            )
        truths[path.stem] = path
    if not truths:
        raise InputError(
            f"{folder} holds no mesh; it should hold the true meshes, {', '.join(MESH_READERS)}."
        )
    for name, path in clouds.items():
        if name not in truths:
            raise InputError(f"{path} is the cloud of {name}, whose mesh is not in {folder}; add it.")
    missing = [name for name in only if name not in truths]
    if missing:
        raise OptionError(
            f"There is no part {missing[0]!r} in {folder}; it has {', '.join(list(truths)[:5])} …"
        )
    chosen = [name for name in truths if not only or name in only]
    return [Part(name, truths[name], clouds.get(name)) for name in chosen]


def cloud_name(path: Path) -> str:
    """NAME of NAME.cloud.EXT, else the empty string."""
    return path.stem.removesuffix(CLOUD) if path.stem.endswith(CLOUD) else ""

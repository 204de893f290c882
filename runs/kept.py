"""What is known of a benchmark's fits, in one small file, so that another machine or another day goes on.

`weingarten bench` makes no fit again whose fit.json and figures.json are there; meshes and checkpoints are
not asked for. `pack` keeps those files (and truths and summaries) of all benchmarks below a folder, `unpack`
lays them out again and leaves alone what is there.
"""

import io
import json
import tarfile
from pathlib import Path

from weingarten.atomic import replacing

NAMES = ("fit.json", "figures.json", "summary.json")
LOCAL = ("truth", "traceback")
"""What a record says of the machine that made it alone."""


def kept(folder: Path) -> list[Path]:
    """The files to keep, in order."""
    own = [path for name in NAMES for path in folder.rglob(name)]
    return sorted([*own, *folder.rglob("truths/*.json")])


def pack(folder: Path, archive: Path) -> int:
    """Write the archive anew; how many files it has. The same files give the same bytes."""
    paths = kept(folder)
    with replacing(archive) as temporary, tarfile.open(temporary, "w:xz") as tar:
        for path in paths:
            known = json.loads(path.read_text(encoding="utf-8"))
            content = json.dumps({key: known[key] for key in known if key not in LOCAL}, indent=1).encode()
            entry = tarfile.TarInfo(path.relative_to(folder).as_posix())
            entry.size = len(content)
            tar.addfile(entry, io.BytesIO(content))
    return len(paths)


def unpack(archive: Path, folder: Path) -> int:
    """Lay out what the archive has and the folder has not; how many files."""
    if not archive.exists():
        return 0
    count = 0
    with tarfile.open(archive, "r:xz") as tar:
        for entry in tar:
            target = folder / entry.name
            content = tar.extractfile(entry)
            if target.exists() or content is None or not target.resolve().is_relative_to(folder.resolve()):
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content.read())
            count += 1
    return count

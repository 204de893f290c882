"""Jobs and their files as one value, for a machine that sees none of this one's folders; and back.

What comes back is written here file by file, each whole or not at all, those that say that a job is done
last. Whoever carries a parcel twice has done nothing worse than to write the same files again.
"""

import json
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from weingarten.atomic import replacing
from weingarten.errors import InputError
from weingarten.many.job import Job, files_in
from weingarten.many.records import make_folder

ROOT, SOURCES = "root", "sources"
WORDS = (".json", ".txt")
"""Extensions of what people read."""
Files = dict[str, bytes]
"""Contents by path, relative and with slashes."""


@dataclass(frozen=True)
class Parcel:
    """jobs: a batch. sources: the files that it reads. kept: what it may go on from.

    places: where the sources and the root are at home.
    """

    jobs: Sequence[Job]
    sources: Files
    kept: Files
    places: dict[str, str]

    @classmethod
    def of(cls, batch: Sequence[Job]) -> "Parcel":
        """A batch's, with all that its jobs need. Raises InputError for a file that is not there any more."""
        root, read = batch[0].root, [path for job in batch for path in job.sources()]
        sources = {path.name: content_of(path) for path in read}
        kept = {within(path, root): content_of(path) for job in batch for path in job.kept()}
        places = {f"{SOURCES}/{path.name}": str(path) for path in read}
        return cls(batch, sources, kept, {**places, ROOT: str(root)})

    def done(self, perform: Callable[[Sequence[Job]], None]) -> Files:
        """Do the jobs in a folder that is gone afterwards; all files that are then under their root."""
        with tempfile.TemporaryDirectory(prefix="weingarten-") as folder:
            here = Path(folder).resolve()
            root, sources = here / ROOT, here / SOURCES
            for place, files in ((root, self.kept), (sources, self.sources)):
                make_folder(place)
                for name, content in files.items():
                    make_folder((place / name).parent)
                    (place / name).write_bytes(content)
            perform([job.moved(root, sources) for job in self.jobs])
            return {within(path, root): self.content(path, here) for path in files_in(root)}

    def content(self, path: Path, here: Path) -> bytes:
        """Of a file; in what people read, the places of files are those at home."""
        content = path.read_bytes()
        if path.suffix in WORDS:
            for name, place in self.places.items():
                said = json.dumps(place)[1:-1] if path.suffix == ".json" else place
                content = content.replace(str(here / name).encode(), said.encode())
        return content


def unpack(files: Files, root: Path) -> None:
    """Write what a machine has sent back. Raises OutputError."""
    for name in sorted(files, key=lambda name: (name.endswith(".json"), name)):
        path = root / name
        make_folder(path.parent)
        with replacing(path) as temporary:
            temporary.write_bytes(files[name])


def content_of(path: Path) -> bytes:
    """Raise InputError where it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error


def within(path: Path, root: Path) -> str:
    """A file's name from its root on."""
    return path.relative_to(root).as_posix()

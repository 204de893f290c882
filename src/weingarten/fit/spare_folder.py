"""A fit that was not asked to keep anything, and becomes a run folder when it would be lost otherwise."""

import shutil
import tempfile
from itertools import count
from pathlib import Path

from weingarten.errors import OutputError
from weingarten.fit.checkpoint import Origin
from weingarten.fit.loop import Loop, Record
from weingarten.fit.run_folder import NoFolder, Points, RunFolder
from weingarten.mesh import Mesh
from weingarten.summary import Summary


class SpareFolder(NoFolder):
    """Becomes a run folder if the fit is interrupted or its mesh cannot be written, and nothing otherwise.

    path: where the folder is to be; one that is there already stays as it is, and another name is taken.
    folder: where it is, once it is made.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.folder: Path | None = None
        self.origin: Origin | None = None
        self.records: list[tuple[Record, float]] = []

    def begin(self, origin: Origin, points: Points, resumed: object) -> None:
        """See Keeper."""
        self.points = points

    def record(self, record: Record, seconds: float) -> None:
        """See Keeper."""
        self.records.append((record, seconds))

    def save(self, loop: Loop, origin: Origin, tensors: dict, extra: dict) -> None:
        """See Keeper."""
        self.loop, self.origin, self.state = loop, origin, (tensors, extra)

    def finish(self, mesh: Mesh, summary: Summary) -> None:
        """See Keeper. Raises OutputError where the folder of an interrupted fit can be made nowhere."""
        if summary.finished or self.origin is None:
            return
        folder = self.keep()
        if folder is None:
            raise OutputError(f"The run folder {self.path} could not be written, nor a temporary one.")
        RunFolder(folder).finish(mesh, summary)

    def keep(self) -> Path | None:
        """The folder from which the fit can go on, made the first time: at its path, else a temporary one.

        None where there is nothing to keep yet, or no room in either place.
        """
        places = [self.path, Path(tempfile.gettempdir()) / self.path.name]
        while self.folder is None and self.origin is not None and places:
            place = free(places.pop(0))
            try:
                self.write(place, self.origin)
            except OutputError:
                shutil.rmtree(place, ignore_errors=True)
            else:
                self.folder = place
        return self.folder

    def write(self, place: Path, origin: Origin) -> None:
        """The state of the fit, as a run folder has it. Raises OutputError."""
        folder = RunFolder(place)
        with folder.held():
            folder.begin(origin, self.points, None)
            for record, seconds in self.records:
                folder.record(record, seconds)
            folder.save(self.loop, origin, *self.state)


def free(path: Path) -> Path:
    """The path, or with the first number behind its stem under which there is nothing."""
    names = (path if k == 1 else path.with_stem(f"{path.stem}-{k}") for k in count(1))
    return next(name for name in names if not name.exists())

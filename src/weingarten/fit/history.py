"""What a field was like on the way: snapshots of its weights, for those who look at a run.

They are taken at steps that the length of the fit alone tells, the k-th of n at (k / (n − 1))^1.5 of it:
close together at first, while shapes form. A checkpoint of a step finds the snapshots up to it kept, so a fit
that is resumed neither lacks one nor has one twice. No fit reads them.
"""

from pathlib import Path

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save
from torch import Tensor

from weingarten.atomic import replacing
from weingarten.errors import CheckpointError, OutputError
from weingarten.fit.checkpoint import separate
from weingarten.fit.loop import Loop

FOLDER = "history"
SNAPSHOTS, BYTES = 16, 24 << 20
"""Of a run: so many at most, and fewer where they would take more than so many bytes."""

CROWDED = 1.5
EXTENSION = ".safetensors"


class History:
    """The snapshots of one run, in a folder of their own. most: how many; 0 keeps none."""

    def __init__(self, run: Path, most: int = SNAPSHOTS) -> None:
        self.path = run / FOLDER
        self.most = most
        self.seen = -1
        self.plan: list[int] | None = None

    def begin(self, resumed: int | None) -> None:
        """Before the first step of a fit that goes on from step `resumed`, if it was begun before.

        What was kept of later steps, or of another fit, is removed. Raises OutputError.
        """
        self.seen = -1 if resumed is None else resumed
        try:
            for step in steps_kept(self.path):
                if step > self.seen:
                    place(self.path, step).unlink()
            for leftover in self.path.glob(f".*-????????{EXTENSION}"):
                leftover.unlink()
            if self.most:
                self.path.mkdir(exist_ok=True)
        except OSError as error:
            raise OutputError(f"{self.path} cannot be written: {error.strerror}.") from error

    def look(self, loop: Loop) -> None:
        """Keep the field as it is, if a snapshot of it is due. Raises OutputError."""
        if self.plan is None:
            self.plan = planned(loop, self.most)
        due = any(self.seen < step <= loop.step for step in self.plan)
        self.seen = max(self.seen, loop.step)
        if not due:
            return
        state = separate(loop.field.state_dict())
        with replacing(place(self.path, loop.step)) as temporary:
            # written here rather than by safetensors, whose error for a full disk is no OSError
            temporary.write_bytes(save(state))


def planned(loop: Loop, most: int = SNAPSHOTS) -> list[int]:
    """The steps after which snapshots are taken, the first and the last among them."""
    size = sum(value.numel() * value.element_size() for value in loop.field.state_dict().values())
    count = min(most, BYTES // max(size, 1))
    if count < 2:
        return []
    return sorted({round(loop.steps * (k / (count - 1)) ** CROWDED) for k in range(count)})


def steps_kept(folder: Path) -> list[int]:
    """The steps that there are snapshots of, ascending; none without the folder."""
    stems = (path.stem for path in folder.glob(f"*{EXTENSION}"))
    return sorted(int(stem) for stem in stems if stem.isdecimal())


def place(folder: Path, step: int) -> Path:
    """Where the snapshot of a step is."""
    return folder / f"{step:07d}{EXTENSION}"


def weights(folder: Path, step: int) -> dict[str, Tensor]:
    """The field's weights after a step, for load_state_dict. Raises CheckpointError."""
    path = place(folder, step)
    if not path.is_file():
        raise CheckpointError(f"There is no snapshot at {path}.")
    try:
        found = load_file(path)
    except (SafetensorError, OSError, ValueError) as error:
        raise CheckpointError(f"{path} cannot be read ({error}).") from error
    if not all(torch.isfinite(value).all() for value in found.values()):
        raise CheckpointError(f"{path} holds numbers that are not finite.")
    return found

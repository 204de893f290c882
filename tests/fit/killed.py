"""Kills a fit with a run folder at every state of its files, one after another, and says what was left.

Run by itself: `python killed.py FOLDER`. A first fit notes, before each of its operations on a file, what
is in the folder: kills between which nothing there changes leave the same, and one of them is enough. The
process forks for every kill, so that imports, machine code and the preparation of the points are had once.
Writes one JSON object: how many operations and kills there were, and what is wrong.
"""

import csv
import hashlib
import json
import os
import shutil
import signal
import sys
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).parent))
from small import small_cloud, small_settings

from weingarten import reconstruction
from weingarten.errors import CheckpointError
from weingarten.fit.run_folder import RunFolder, opened
from weingarten.io.mesh import write_mesh
from weingarten.observer import Observer
from weingarten.start import Start

NAMES = {
    "config.toml",
    "loss.csv",
    "checkpoint.safetensors",
    "cloud.npy",
    "history",
    "mesh.ply",
    "summary.json",
}
STEPS, CLOUD = 3, small_cloud()


class Stopping(Observer):
    """Interrupts after the second step."""

    taken = 0

    def step(self, *_: object) -> None:
        """See Observer."""
        self.taken += 1

    def interrupted(self) -> bool:
        """See Observer."""
        return self.taken == 2


def fit(folder: Path, output: Path, resume: bool, seed: int = 0, observer: Observer | None = None) -> None:
    """What the command does."""
    settings = small_settings(STEPS, seed)
    keeper = RunFolder(folder)
    result = reconstruction.reconstruct(CLOUD, settings, run_folder=keeper, resume=resume, observer=observer)
    write_mesh(output, result.mesh)


def in_a_fork(work) -> int:
    """The status with which a copy of this process ends after it has done the work."""
    pid = os.fork()
    if pid == 0:
        work()
        os._exit(0)
    return os.waitpid(pid, 0)[1]


def counting(folder: Path, act) -> None:
    """Call act(n) before the n-th operation on a file in the folder, but for what it does itself."""
    seen, acting = [0], [False]

    def hook(event: str, arguments: tuple) -> None:
        ours = event.startswith(("open", "os.", "shutil.")) and str(folder) in str(arguments[0])
        if ours and not acting[0]:
            seen[0] += 1
            acting[0] = True
            act(seen[0])
            acting[0] = False

    sys.addaudithook(hook)


def operations(folder: Path, output: Path, work) -> list[str]:
    """Of each operation on a file that the work consists of, what there is before it."""
    reading, writing = os.pipe()

    def note(_: int) -> None:
        os.write(writing, contents(folder, output).encode() + b"\n")

    in_a_fork(lambda: (counting(folder, note), work()))
    os.close(writing)
    with os.fdopen(reading, encoding="ascii") as stream:
        return stream.read().split()


def contents(folder: Path, output: Path) -> str:
    """A hash of every byte of the files, and of their names but for what is random in temporary ones."""
    found = hashlib.sha256()
    for path in [output, *sorted(folder.rglob("*"))]:
        found.update(path.name.split("-")[0].encode() + (path.read_bytes() if path.is_file() else b""))
    return found.hexdigest()


def state(folder: Path) -> tuple:
    """What tells one folder from another: names, the checkpoint, and how many rows the loss curve has."""
    names = sorted(path.name.split("-")[0] for path in folder.rglob("*"))
    kept, rows = folder / "checkpoint.safetensors", folder / "loss.csv"
    return (*names, kept.exists() and kept.read_bytes(), rows.exists() and rows.read_bytes().count(b"\n"))


def curve(folder: Path) -> list[list[str]]:
    """The loss curve without its seconds."""
    with (folder / "loss.csv").open(newline="") as stream:
        return [row[:4] + row[5:] for row in csv.reader(stream)]


def snapshots(folder: Path) -> dict[str, bytes]:
    """What is kept of the field on its way."""
    return {path.name: path.read_bytes() for path in (folder / "history").iterdir()}


def faults(folder: Path, output: Path, whole: Path, earlier: bytes, seen: set) -> list[str]:
    """What is wrong with what a kill has left, and with the fit that goes on from it."""
    wrong = []
    new = (whole / "mesh.ply").read_bytes()
    if output.read_bytes() not in (earlier, new):
        wrong.append("the output is neither the earlier mesh nor the new one")
    now = state(folder)
    if now in seen:
        return wrong
    seen.add(now)
    try:
        resume = opened(folder)[0].origin.settings.seed == 0
    except CheckpointError as error:
        resume = False
        if "There is no checkpoint" not in str(error):
            wrong.append(str(error))
    in_a_fork(lambda: fit(folder, output, resume))
    if {path.name for path in folder.iterdir()} != NAMES:
        wrong.append(f"the folder holds {sorted(path.name for path in folder.iterdir())}")
    if (folder / "mesh.ply").read_bytes() != new or output.read_bytes() != new:
        wrong.append("another mesh after going on")
    if snapshots(folder) != snapshots(whole):
        wrong.append(f"other snapshots after going on: {sorted(snapshots(folder))}")
    if curve(folder) != curve(whole):
        wrong.append("another loss curve after going on")
    return wrong


def killed(folder: Path, whole: Path, output: Path, resumed: bool) -> dict:
    """Kill, look and go on, for every operation of a fit begun over another one, or resumed."""
    before, trial = folder / f"before {resumed}", folder / "trial"
    reconstruction.Start = Start
    fit(before, output, False, seed=0 if resumed else 1, observer=Stopping() if resumed else None)
    earlier, wrong, seen = output.read_bytes(), {}, set()

    def fresh() -> None:
        shutil.rmtree(trial, ignore_errors=True)
        shutil.copytree(before, trial)
        output.write_bytes(earlier)

    def work() -> None:
        fit(trial, output, resumed)

    start = Start.of(CLOUD, small_settings(STEPS), reconstruction.chosen_device("cpu"))
    # every fit from here on is in a fork, and may use up its own copy
    reconstruction.Start = SimpleNamespace(of=lambda *_: start)
    fresh()
    found = operations(trial, output, work)
    kills = sorted(found.index(each) + 1 for each in set(found))
    for n in kills:
        fresh()
        kill = lambda at, n=n: os.kill(os.getpid(), signal.SIGKILL) if at == n else None  # noqa: E731
        status = in_a_fork(lambda kill=kill: (counting(trial, kill), work()))
        if os.WTERMSIG(status) != signal.SIGKILL:
            wrong[n] = ["it was not killed"]
        elif told := faults(trial, output, whole, earlier, seen):
            wrong[n] = told
    return {"operations": len(found), "kills": len(kills), "states": len(seen), "wrong": wrong}


def main() -> None:
    """Both kinds."""
    folder = Path(sys.argv[1])
    reconstruction.CHECKPOINT_SECONDS = -1.0
    whole, output = folder / "whole", folder / "part.ply"
    fit(whole, output, False)
    found = {name: killed(folder, whole, output, name == "resumed") for name in ("anew", "resumed")}
    json.dump(found, sys.stdout)


if __name__ == "__main__":
    main()

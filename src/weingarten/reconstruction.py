"""Points in, mesh out: the whole way of a scan through the house."""

import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float64
from scipy.spatial import KDTree
from torch import nn

from weingarten.calculus.choice import exact
from weingarten.calculus.native import Native, is_compiled
from weingarten.crew import THREADS, Crew, crew_for
from weingarten.device import chosen_device
from weingarten.errors import FitError
from weingarten.fit import checkpoint
from weingarten.fit.checkpoint import Checkpoint, Origin
from weingarten.fit.estimate import estimate
from weingarten.fit.loop import Loop, Record, run
from weingarten.fit.run_folder import Keeper, NoFolder, RunFolder
from weingarten.mesh import Mesh
from weingarten.metrics.topology import topology
from weingarten.observer import Observer
from weingarten.oracle import Oracle
from weingarten.scan.noise import noise_level
from weingarten.scan.thinning import thinned
from weingarten.settings import Settings, resolve
from weingarten.start import Start
from weingarten.summary import Summary, borne_out, summarise
from weingarten.surface.cloud_planes import cloud_planes
from weingarten.surface.contour import Extraction, extraction
from weingarten.surface.decimation import Decimation, decimated, required
from weingarten.surface.folds import unfolded
from weingarten.surface.handles import reach_of, without_handles
from weingarten.surface.lattice import Lattice
from weingarten.surface.marching_cubes import marching_cubes
from weingarten.surface.octree import Values
from weingarten.surface.outer_faces import within_outer_faces
from weingarten.surface.repair import drop_ghosts
from weingarten.surface.sharp_contour import SharpContour
from weingarten.surface.trim import trimmed
from weingarten.surface.values import BATCH, field_jets, field_planes, field_values
from weingarten.world_field import WorldField

Points = Float64[np.ndarray, "n 3"]

CHECKPOINT_SECONDS = 2.0
"""Seconds between checkpoints: what a kill can lose."""

COMPILING = "Compiling for this processor, which takes ten seconds or more before the first fit alone."
"""Said of a silence in which nothing else could be told from a program that hangs."""


@dataclass(frozen=True)
class Result:
    """mesh: world frame. field: callable on world points. summary: quality without ground truth.

    finished: False when the fit was interrupted; the mesh is then that of the steps taken.
    """

    mesh: Mesh
    field: WorldField
    summary: Summary
    settings: Settings
    finished: bool


@dataclass(frozen=True)
class Ending:
    """How a fit ended: steps taken, whether these were all, and the loss of the last, None where none was."""

    steps: int
    finished: bool
    loss: float | None


@dataclass
class Clock:
    """Seconds by phase."""

    observer: Observer
    seconds: dict[str, float] = field(default_factory=dict)
    name: str = ""
    started: float = 0.0

    def phase(self, name: str) -> None:
        """End the running phase and begin another; the empty name ends the last."""
        now = time.perf_counter()
        if self.name:
            self.seconds[self.name] = round(now - self.started, 3)
        self.name, self.started = name, now
        if name:
            self.observer.phase(name)


def reconstruct(
    points: Points,
    settings: Settings | None = None,
    *,
    device: str = "auto",
    run_folder: str | Path | Keeper | None = None,
    resume: bool = False,
    truth: Mesh | None = None,
    module: nn.Module | None = None,
    observer: Observer | None = None,
) -> Result:
    """Fit a signed distance field to an unoriented cloud and extract its surface.

    points: (n, 3), any unit and offset; kept in float64 until centred. Of very many, the
        fit draws from a part picked at random (`weingarten.scan.thinning`), and a note says so.
    settings: from `weingarten.resolve`; by default the `standard` preset with seed 0.
    device: auto, cpu, cuda or mps.
    run_folder: where checkpoint, loss curve, mesh and summary go.
    resume: go on from the checkpoint in run_folder, to the same mesh if there are as many threads.
    truth: ask for the oracle's early stopping by distance to this mesh; such figures are not comparable.
    module: a network f: (n, 3) → (n,) of the unit frame to fit instead of a SIREN.
    observer: who watches.

    Raises CloudError for points that hold no part, CheckpointError for a run folder of another fit, BusyError
    for one that another process writes, OutputError where it cannot be written, DeviceError, ExtractionError
    when the field has no surface, FitError when the loss is not finite, MissingExtraError where fewer
    triangles are asked for without the extra `simplify`.
    """
    settings = settings or resolve()
    if settings.simplify > 0.0:
        required()
    observer = observer or Observer()
    clock = Clock(observer)
    target = chosen_device(device)
    keeper = keeper_of(run_folder)
    THREADS.join()
    with keeper.held():
        clock.phase("preparing")
        start = Start.of(points, settings, target, module)
        loop = start.loop()
        origin = start.origin
        oracle = None if truth is None else Oracle(truth)
        found = None
        if resume:
            found = keeper.found()
            checkpoint.check_same(found.origin, origin)
            found.restore(loop)
            for note in threads_notes(found.threads, loop.crew.size):
                observer.note(note)
            if oracle is not None:
                oracle.restore(found)
        for note in start.notes:
            observer.note(note)
        keeper.begin(origin, start.cloud, found)
        if isinstance(exact(loop.field), Native) and not is_compiled():
            observer.note(COMPILING)
        observer.expect(estimate(loop, origin.cells), settings.steps)
        clock.phase("fitting")
        finished, loss = fit(loop, origin, keeper, observer, oracle)
        if oracle is not None:
            oracle.choose(loop)
        result = concluded(start, loop.field, Ending(loop.step, finished, loss), clock, loop.crew)
        keeper.finish(result.mesh, result.summary)
    return result


def concluded(start: Start, field: nn.Module, ending: Ending, clock: Clock, crew: Crew) -> Result:
    """The result of a fit that has come to its end: the field's surface, measured. Ends the clock.

    Raises ExtractionError when the field has no surface.
    """
    clock.phase("extracting")
    mesh, notes = surface(field, start.origin, start.unit, crew)
    for note in notes:
        clock.observer.note(note)
    clock.phase("measuring")
    noise = start.noise * start.frame.scale
    world = borne_out(Mesh(start.frame.to_world(mesh.vertices), mesh.faces), start.cloud, noise)
    seconds, notes, planned = clock.seconds, (*start.notes, *notes), start.settings.steps
    summary = summarise(
        start.cloud, world, noise, ending.steps, planned, ending.finished, ending.loss, seconds, notes
    )
    summary = replace(summary, doubts=(*start.doubts, *summary.doubts))
    for doubt in summary.doubts:
        clock.observer.note(doubt)
    clock.phase("")
    return Result(world, WorldField(field, start.frame), summary, start.settings, ending.finished)


def prepared(points: Points, settings: Settings, device: torch.device) -> Loop:
    """The loop of a fit before its first step, for those who only want to know what it costs."""
    start = Start.of(points, settings, device)
    return start.loop()


def keeper_of(run_folder: str | Path | Keeper | None) -> Keeper:
    """A folder's keeper; a keeper is returned as it is."""
    if run_folder is None:
        return NoFolder()
    return RunFolder(Path(run_folder)) if isinstance(run_folder, str | Path) else run_folder


def fit(
    loop: Loop, origin: Origin, keeper: Keeper, observer: Observer, oracle: Oracle | None
) -> tuple[bool, float | None]:
    """Step to the end, keeping checkpoints; whether it was reached, and the last loss."""
    last: list[float] = []
    saved = time.monotonic()

    def save() -> None:
        keeper.look(loop)
        tensors, extra = ({}, {}) if oracle is None else (oracle.tensors(), oracle.extra())
        keeper.save(loop, origin, tensors, extra)

    def each(record: Record, seconds: float) -> None:
        check_finite(record)
        last[:] = [record.loss]
        keeper.record(record, seconds)
        observer.step(record, loop.steps, seconds)

    satisfied = False

    def stop() -> bool:
        nonlocal satisfied, saved
        keeper.look(loop)
        if time.monotonic() - saved > CHECKPOINT_SECONDS:
            save()
            saved = time.monotonic()
        satisfied = oracle is not None and oracle.watch(loop, origin)
        return satisfied or observer.interrupted()

    save()
    finished = run(loop, each, stop)
    if oracle is not None and finished:
        oracle.watch(loop, origin)
    save()
    return finished or satisfied, last[0] if last else None


def threads_notes(before: int, now: int) -> tuple[str, ...]:
    """What to know of a fit that goes on with another number of threads than it was begun with."""
    if before in (0, now):
        return ()
    return (
        f"The checkpoint was written with {before} thread{'s' * (before > 1)}, and this fit goes on with "
        f"{now}: its mesh will be another than without the interruption.",
    )


def check_finite(record: Record) -> None:
    """Raise FitError where the loss is none."""
    if not np.isfinite(record.loss):
        raise FitError(f"The loss became {record.loss} at step {record.step}; try another --seed.")


def surface(module: nn.Module, origin: Origin, unit: Points, crew: Crew) -> tuple[Mesh, tuple[str, ...]]:
    """The field's surface without ghosts, unit frame, and notes on what was done to it.

    Raises ExtractionError when there is none, or none near the points and only that is wanted.
    """
    values, settings = field_values(module, crew), origin.settings
    lower, upper = np.array(origin.lower), np.array(origin.upper)
    planes = field_planes(module, crew)
    mesher = SharpContour(planes, cloud_planes(unit, planes), crew) if settings.sharp else marching_cubes

    def made(values: Values) -> Extraction:
        return extraction(values, lower, upper, origin.cells, BATCH, crew, mesher)

    def remade(values: Values) -> Mesh:
        return drop_ghosts(made(values).mesh, unit)

    found = made(values)
    mesh = drop_ghosts(found.mesh, unit)
    notes = (*fineness_notes(origin), *found.notes)
    if len(mesh.faces) < len(found.mesh.faces):
        dropped = len(found.mesh.faces) - len(mesh.faces)
        notes = (*notes, f"{dropped:,} faces that no points support were removed as ghosts.")
    if settings.sharp:
        whole, reach, jets = mesh, reach_of(unit, origin.apart), field_jets(module, crew)
        lattice = Lattice.over(lower, upper, origin.cells)
        mesh = without_handles(whole, remade, values, jets, reach, lattice)
        notes = (*notes, *handle_notes(whole, mesh, 2.0 * reach * origin.frame.scale))
        mesh = unfolded(within_outer_faces(mesh, unit), lattice.step)
    if settings.trim > 0.0:
        mesh = trimmed(mesh, unit, settings.trim / origin.frame.scale)
    if settings.simplify > 0.0:
        fewer = decimated(mesh, settings.simplify / origin.frame.scale)
        notes, mesh = (*notes, stand_in_note(mesh, fewer, origin)), fewer.mesh
    return mesh, notes


def handle_notes(mesh: Mesh, fewer: Mesh, width: float) -> tuple[str, ...]:
    """What the user should know of handles that were closed."""
    if fewer is mesh:
        return ()
    before, after = topology(mesh).genus, topology(fewer).genus
    if before is None or after is None:
        return ()
    what = "hole or bridge" if before - after == 1 else "holes or bridges"
    return (
        f"{before - after} {what} narrower than {width:.2g}, of which the points say nothing, closed or cut.",
    )


def fineness_notes(origin: Origin) -> tuple[str, ...]:
    """What the user should know of the lattice."""
    if origin.cells == origin.settings.resolution:
        return ()
    apart, asked = origin.apart * origin.frame.scale, origin.settings.resolution
    return (
        f"Walls or gaps are as thin as {apart:.3g}: the mesh is made with {origin.cells} cells along the "
        f"longest side rather than {asked}.",
    )


def stand_in_note(whole: Mesh, fewer: Decimation, origin: Origin) -> str:
    """What the user should know of fewer triangles."""
    if fewer.mesh is whole:
        return "No fewer triangles are as closed, with as many pieces and handles; all of them were kept."
    stand = f"{len(fewer.mesh.faces):,} triangles stand for {len(whole.faces):,}"
    within, most = origin.settings.simplify, fewer.farthest * origin.frame.scale
    return f"{stand}, within {within:g} of them at 999 of 1,000 places and {most:.2g} at most."


def remesh(
    found: Checkpoint,
    points: Points,
    device: torch.device,
    resolution: int | None = None,
    sharp: bool | None = None,
    trim: float | None = None,
    simplify: float | None = None,
) -> tuple[Mesh, tuple[str, ...]]:
    """The surface of a checkpoint's field, world frame, and notes.

    points: of its run, world units. resolution, sharp, trim, simplify: those of its settings unless given.

    Raises MissingExtraError where fewer triangles are asked for without the extra `simplify`.
    """
    THREADS.join()
    field, frame, settings = WorldField.of(found, device), found.origin.frame, found.origin.settings
    settings = replace(
        settings,
        resolution=settings.resolution if resolution is None else resolution,
        sharp=settings.sharp if sharp is None else sharp,
        trim=settings.trim if trim is None else trim,
        simplify=settings.simplify if simplify is None else simplify,
    )
    if settings.simplify > 0.0:
        required()
    given = frame.to_unit(thinned(points, settings.seed))
    unit = settings.resolved_method().preparation.settle(given).points
    mesh, notes = surface(field.module, replace(found.origin, settings=settings), unit, crew_for(device))
    world = Mesh(frame.to_world(mesh.vertices), mesh.faces)
    return borne_out(world, points, noise_level(given, KDTree(given)) * frame.scale), notes

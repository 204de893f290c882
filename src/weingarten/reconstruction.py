"""Points in, mesh out: the whole way of a scan through the house."""

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float64
from scipy.spatial import KDTree
from torch import nn

from weingarten.crew import Crew, crew_for
from weingarten.device import chosen_device
from weingarten.errors import CheckpointError, FitError
from weingarten.fields.siren import Siren
from weingarten.fit import checkpoint
from weingarten.fit.checkpoint import Checkpoint, Origin
from weingarten.fit.estimate import estimate
from weingarten.fit.loop import CHUNK, GPU_CHUNK, Loop, Record, run
from weingarten.fit.optimisers import OPTIMISERS, RATES
from weingarten.fit.run_folder import Keeper, NoFolder, RunFolder
from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.observer import Observer
from weingarten.oracle import Oracle
from weingarten.scan.diagnose import diagnose
from weingarten.scan.draws import REACH, CloudDraws, Draws, SignedDraws
from weingarten.scan.free_space import FreeSpace
from weingarten.settings import Settings, resolve
from weingarten.summary import Summary, summarise
from weingarten.surface.contour import extraction
from weingarten.surface.repair import drop_ghosts
from weingarten.surface.values import field_values
from weingarten.terms.free_space import FREE_SPACE
from weingarten.world_field import WorldField

Points = Float64[np.ndarray, "n 3"]

MARGIN = 0.05
"""Room left around the cloud for the surface, unit lengths."""

CHECKPOINT_SECONDS = 2.0
"""Seconds between checkpoints: what a kill can lose."""


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

    points: (n, 3), any unit and offset; kept in float64 until centred.
    settings: from `weingarten.resolve`; by default the `standard` preset with seed 0.
    device: auto, cpu, cuda or mps.
    run_folder: where checkpoint, loss curve, mesh and summary go.
    resume: go on from the checkpoint in run_folder, to the same mesh.
    truth: ask for the oracle's early stopping by distance to this mesh; such figures are not comparable.
    module: a network f: (n, 3) → (n,) of the unit frame to fit instead of a SIREN.
    observer: who watches.

    Raises CloudError for points that hold no part, CheckpointError for a run folder of another fit,
    DeviceError, ExtractionError when the field has no surface, FitError when the loss is not finite.
    """
    settings = settings or resolve()
    observer = observer or Observer()
    clock = Clock(observer)
    target = chosen_device(device)
    keeper = keeper_of(run_folder)
    clock.phase("preparing")
    diagnosis = diagnose(np.asarray(points, dtype=np.float64))
    cloud = diagnosis.points
    frame = Frame.of(cloud)
    unit = frame.to_unit(cloud)
    tree = KDTree(unit)
    generator = torch.Generator().manual_seed(settings.seed)
    loop, notes = first_loop(settings, unit, tree, generator, module, target)
    origin = origin_of(settings, frame, unit, cloud)
    notes = (*diagnosis.notes, *notes)
    oracle = None if truth is None else Oracle(truth)
    found = None
    if resume:
        found = keeper.found()
        checkpoint.check_same(found.origin, origin)
        found.restore(loop)
        if oracle is not None:
            oracle.restore(found)
    for note in notes:
        observer.note(note)
    keeper.begin(origin, cloud, found)
    observer.expect(estimate(loop, settings.resolution), settings.steps)
    clock.phase("fitting")
    finished, loss = fit(loop, origin, keeper, observer, oracle)
    if oracle is not None:
        oracle.choose(loop)
    clock.phase("extracting")
    mesh, mesh_notes = surface(loop.field, origin, unit, settings.resolution, loop.crew)
    for note in mesh_notes:
        observer.note(note)
    clock.phase("measuring")
    world = Mesh(frame.to_world(mesh.vertices), mesh.faces)
    notes = (*notes, *mesh_notes)
    summary = summarise(cloud, world, loop.step, settings.steps, finished, loss, clock.seconds, notes)
    clock.phase("")
    keeper.finish(world, summary)
    return Result(world, WorldField(loop.field, frame), summary, settings, finished)


def prepared(points: Points, settings: Settings, device: torch.device) -> Loop:
    """The loop of a fit before its first step, for those who only want to know what it costs."""
    unit = Frame.of(points).to_unit(points)
    generator = torch.Generator().manual_seed(settings.seed)
    return first_loop(settings, unit, KDTree(unit), generator, None, device)[0]


def keeper_of(run_folder: str | Path | Keeper | None) -> Keeper:
    """A folder's keeper; a keeper is returned as it is."""
    if run_folder is None:
        return NoFolder()
    return RunFolder(Path(run_folder)) if isinstance(run_folder, str | Path) else run_folder


def first_loop(
    settings: Settings,
    unit: Points,
    tree: KDTree,
    generator: torch.Generator,
    module: nn.Module | None,
    device: torch.device,
) -> tuple[Loop, tuple[str, ...]]:
    """The loop before its first step, and notes on the signs that free space gave."""
    network = module or Siren(settings.width, settings.depth, settings.frequency, generator)
    network = network.to(device)
    method = settings.resolved_method()
    draws: Draws
    notes: tuple[str, ...] = ()
    if FREE_SPACE in method.terms:
        space = FreeSpace.of(unit, tree, REACH)
        draws, notes = SignedDraws(unit, tree, space, generator), space.notes
    else:
        draws = CloudDraws(unit, tree)
    crew = crew_for(device)
    loop = Loop(
        field=network,
        method=method,
        draws=draws,
        generator=generator,
        optimisers=OPTIMISERS[settings.optimiser](network, crew),
        rate=RATES[settings.decay],
        base_rate=settings.rate,
        steps=settings.steps,
        points=settings.points,
        clip=settings.clip,
        ramp=settings.ramp,
        chunk=CHUNK if device.type == "cpu" else GPU_CHUNK,
        crew=crew,
    )
    return loop, notes


def origin_of(settings: Settings, frame: Frame, unit: Points, cloud: Points) -> Origin:
    """What a checkpoint of this fit belongs to, and the box its surface is looked for in."""
    lower = np.maximum(unit.min(axis=0) - MARGIN, -REACH)
    upper = np.minimum(unit.max(axis=0) + MARGIN, REACH)
    return Origin(settings, frame, checkpoint.fingerprint(cloud), triple(lower), triple(upper))


def triple(vector: Float64[np.ndarray, " 3"]) -> tuple[float, float, float]:
    """Three plain floats."""
    return float(vector[0]), float(vector[1]), float(vector[2])


def fit(
    loop: Loop, origin: Origin, keeper: Keeper, observer: Observer, oracle: Oracle | None
) -> tuple[bool, float | None]:
    """Step to the end, keeping checkpoints; whether it was reached, and the last loss."""
    last: list[float] = []
    saved = time.monotonic()

    def save() -> None:
        tensors, extra = ({}, {}) if oracle is None else (oracle.tensors(), oracle.extra())
        keeper.save(loop, origin, tensors, extra)

    def each(record: Record, seconds: float) -> None:
        nonlocal saved
        if not np.isfinite(record.loss):
            raise FitError(f"The loss became {record.loss} at step {record.step}; try another --seed.")
        last[:] = [record.loss]
        keeper.record(record, seconds)
        observer.step(record, loop.steps, seconds)
        if time.monotonic() - saved > CHECKPOINT_SECONDS:
            save()
            saved = time.monotonic()

    satisfied = False

    def stop() -> bool:
        nonlocal satisfied
        satisfied = oracle is not None and oracle.watch(loop, origin)
        return satisfied or observer.interrupted()

    save()
    finished = run(loop, each, stop) or satisfied
    save()
    return finished, last[0] if last else None


def surface(
    module: nn.Module, origin: Origin, unit: Points, resolution: int, crew: Crew
) -> tuple[Mesh, tuple[str, ...]]:
    """The field's surface without ghosts, unit frame, and notes on what was done to it."""
    values = field_values(module, crew)
    found = extraction(values, np.array(origin.lower), np.array(origin.upper), resolution, batch=1 << 17)
    mesh = drop_ghosts(found.mesh, unit)
    if len(mesh.faces) == len(found.mesh.faces):
        return mesh, found.notes
    dropped = len(found.mesh.faces) - len(mesh.faces)
    return mesh, (*found.notes, f"{dropped:,} faces that no points support were removed as ghosts.")


def remesh(
    found: Checkpoint, points: Points, resolution: int, device: torch.device
) -> tuple[Mesh, tuple[str, ...]]:
    """The surface of a checkpoint's field, world frame, and notes. points: of its run, world units."""
    settings, frame = found.origin.settings, found.origin.frame
    field = Siren(settings.width, settings.depth, settings.frequency)
    try:
        field.load_state_dict(found.kept_state() or found.field_state())
    except RuntimeError as error:
        raise CheckpointError(
            "The run was fitted with a network of its own; extract it in Python."
        ) from error
    mesh, notes = surface(field.to(device), found.origin, frame.to_unit(points), resolution, crew_for(device))
    return Mesh(frame.to_world(mesh.vertices), mesh.faces), notes

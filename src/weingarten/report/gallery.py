"""A part's pictures, from one camera and with one scale of distances, and its scenes for the view in 3D."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from weingarten.bench.metric import METRICS, Metric
from weingarten.bench.results import Result
from weingarten.bench.store import Store
from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.metrics.distance import Nearby
from weingarten.metrics.unit_cube import cube_frame
from weingarten.report import scene as packing
from weingarten.report.camera import SUPERSAMPLING, Camera
from weingarten.report.heat import Distances, Scale, scale_for, seen_distances
from weingarten.report.image import data_uri, small
from weingarten.report.panel import Panel, cut_out, seen
from weingarten.report.refine import Levels, Points
from weingarten.report.scene import Scene
from weingarten.report.simplify import simplified
from weingarten.report.sources import mesh_of, shown_fits, truth_of

PANEL = 440
"""Width of a picture, pixels."""
THUMBNAIL = 132
DRAWN = 150_000
"""Larger meshes are drawn with so many triangles."""


Changes = dict[str, str | Scene]
"""Fields of a card and their values."""


@dataclass(frozen=True)
class Shown:
    """A figure beside a picture. best: of the contenders on this part."""

    label: str
    text: str
    best: bool


@dataclass(frozen=True)
class Card:
    """One contender on one part. Pictures are data URIs, None where there is none.

    figures: by protocol. note: why there is no mesh. remarks: of the fit. triangles: of the mesh in its file.
    error: the mesh, coloured by its distance to the truth. missed: the truth, coloured by its distance to the
    mesh; missed_levels: the same for the vertices of the truth's scene, packed.
    """

    contender: str
    seed: int
    figures: tuple[tuple[str, tuple[Shown, ...]], ...]
    note: str = ""
    remarks: tuple[str, ...] = ()
    triangles: int | None = None
    shaded: str | None = None
    error: str | None = None
    missed: str | None = None
    scene: Scene | None = None
    missed_levels: str | None = None


@dataclass(frozen=True)
class TruthView:
    """The truth of a part. thumbnail, shaded: data URIs. triangles: in its file."""

    triangles: int
    shaded: str
    thumbnail: str
    scene: Scene


@dataclass(frozen=True)
class PartView:
    """One part. size: of a picture, pixels. side: the truth's longest, in the unit of the input.

    target, extent: what the camera looks at and how wide a panel is, in the scenes' unit frame.
    truth, scale: None without the truth; note says why.
    """

    name: str
    note: str
    size: tuple[int, int]
    side: float
    target: tuple[float, float, float]
    extent: float
    scale: Scale | None
    truth: TruthView | None
    cards: tuple[Card, ...]


@dataclass(frozen=True)
class Stage:
    """What a part's pictures have in common. triangles: of a mesh's scene."""

    frame: Frame
    camera: Camera
    triangles: int


@dataclass(frozen=True)
class Drawn:
    """A mesh as it is drawn, and ready to be asked for its nearest places."""

    mesh: Mesh
    panel: Panel
    nearest: Nearby


@dataclass(frozen=True)
class Compared:
    """A contender's mesh and the truth. error, missed: distances of what is seen of it and of the truth."""

    own: Drawn
    error: Distances
    missed: Distances


def part_view(
    store: Store, found: Sequence[Result], part: str, names: Sequence[str], triangles: int
) -> PartView:
    """Everything that is shown of a part. names: of the contenders, in order. triangles: of a scene."""
    fits = shown_fits(found, part, names)
    truth, note = truth_of(store, fits)
    meshes, bare = {}, {}
    for one, figures in zip(fits, figures_beside(fits), strict=True):
        mesh, why = mesh_of(one)
        count = None if mesh is None else len(mesh.faces)
        remarks = tuple(map(str, one.fit.get("notes") or ()))
        bare[one.contender] = Card(one.contender, one.seed, figures, why, remarks, count)
        if mesh is not None:
            meshes[one.contender] = simplified(mesh, DRAWN)
    reference = truth or next(iter(meshes.values()), None)
    if reference is None:
        nowhere = (0.0, 0.0, 0.0)
        return PartView(part, note, (PANEL, PANEL), 0.0, nowhere, 1.0, None, None, tuple(bare.values()))
    camera = Camera.around(reference.corners.reshape(-1, 3), PANEL)
    stage = Stage(cube_frame(reference), camera, triangles)
    drawn = {name: drawn_mesh(mesh, stage) for name, mesh in meshes.items()}
    scale, shown_truth = None, None
    if truth is None:
        made = {name: without_truth(own, stage) for name, own in drawn.items()}
    else:
        front = drawn_mesh(simplified(truth, DRAWN), stage)
        compared = {name: beside(own, front) for name, own in drawn.items()}
        distances = [np.concatenate([own.error, own.missed]) for own in compared.values()]
        scale = scale_for(stage.frame.scale, distances)
        shown_truth, made = with_truth(front, compared, scale, stage, len(truth.faces))
    cards = tuple(replace(card, **made.get(name, {})) for name, card in bare.items())
    return PartView(
        name=part,
        note=note,
        size=(PANEL, camera.height // SUPERSAMPLING),
        side=stage.frame.scale,
        target=as_tuple(stage.frame.to_unit(camera.centre[None])[0]),
        extent=camera.width / camera.scale / stage.frame.scale,
        scale=scale,
        truth=shown_truth,
        cards=cards,
    )


def drawn_mesh(mesh: Mesh, stage: Stage) -> Drawn:
    """A mesh from the part's camera."""
    return Drawn(mesh, seen(mesh, stage.camera), Nearby(mesh))


def beside(own: Drawn, front: Drawn) -> Compared:
    """A contender's mesh and the truth, each with its distances to the other."""
    error, missed = seen_distances(own.panel, front.nearest), seen_distances(front.panel, own.nearest)
    return Compared(own, error, missed)


def without_truth(own: Drawn, stage: Stage) -> Changes:
    """The picture and the scene of a mesh alone."""
    slim = packing.slim(own.mesh, stage.triangles, 1.0, packing.uncoloured)
    return {"shaded": shaded(own.panel), "scene": packing.scene(slim.mesh, stage.frame)}


def with_truth(
    front: Drawn, compared: dict[str, Compared], scale: Scale, stage: Stage, triangles: int
) -> tuple[TruthView, dict[str, Changes]]:
    """What is shown of a truth of so many triangles, and the pictures and scenes of every contender."""
    trees = [one.own.nearest for one in compared.values()]

    def missed_at(points: Points) -> Levels:
        return np.stack(
            [*(scale.places(tree.closest(points).distance) for tree in trees)] or [np.zeros(len(points))],
            axis=1,
        )

    most = int(packing.TRUTHS_SHARE * stage.triangles)
    slim = packing.slim(front.mesh, most, packing.TRUTHS_SHAPE, missed_at)
    image = cut_out(front.panel.shaded(), front.panel.seen)
    view = TruthView(
        triangles, data_uri(image), data_uri(small(image, THUMBNAIL)), packing.scene(slim.mesh, stage.frame)
    )
    made = {}
    for number, (name, one) in enumerate(compared.items()):
        made[name] = pictured(one, front, scale, stage) | {
            "missed": heat(front.panel, scale, one.missed),
            "missed_levels": packing.packed(slim.levels[:, number].tobytes()),
        }
    return view, made


def pictured(one: Compared, front: Drawn, scale: Scale, stage: Stage) -> Changes:
    """The pictures and the scene of a contender's mesh; colours are those of the whole mesh's places."""

    def error_at(points: Points) -> Levels:
        return scale.places(front.nearest.closest(one.own.nearest.closest(points).position).distance)[:, None]

    slim = packing.slim(one.own.mesh, stage.triangles, packing.SHAPE, error_at)
    return {
        "shaded": shaded(one.own.panel),
        "error": heat(one.own.panel, scale, one.error),
        "scene": packing.scene(slim.mesh, stage.frame, slim.levels[:, 0]),
    }


def shaded(panel: Panel) -> str:
    """A surface in light and shade."""
    return data_uri(cut_out(panel.shaded(), panel.seen))


def heat(panel: Panel, scale: Scale, distances: Distances) -> str:
    """A surface in the colours of its distances."""
    return data_uri(cut_out(panel.coloured(scale.colours(distances)), panel.seen))


def figures_beside(fits: Sequence[Result]) -> list[tuple[tuple[str, tuple[Shown, ...]], ...]]:
    """The figures of each of a part's fits by protocol; nothing of a fit that has none."""
    metrics = [metric for metric in METRICS if any(one.number(metric.key) is not None for one in fits)]
    best = {metric: best_loss(metric, fits) for metric in metrics}
    protocols = list(dict.fromkeys(metric.protocol for metric in metrics))
    return [
        tuple(
            (protocol, tuple(shown(m, one, best[m]) for m in metrics if m.protocol == protocol))
            for protocol in protocols
            if one.good
        )
        for one in fits
    ]


def best_loss(metric: Metric, fits: Sequence[Result]) -> float | None:
    """The least loss of several fits; None where none is better than another."""
    losses = {metric.loss(value) for one in fits if (value := one.number(metric.key)) is not None}
    return min(losses) if len(losses) > 1 else None


def shown(metric: Metric, one: Result, best: float | None) -> Shown:
    """One figure of one fit."""
    value = one.number(metric.key)
    text = metric.shown(value)
    if isinstance(one.values.get(metric.key), bool):
        text = "yes" if value else "no"
    unit = f" {metric.unit}" if metric.unit and value is not None and text not in ("yes", "no") else ""
    return Shown(metric.label, text + unit, value is not None and metric.loss(value) == best)


def as_tuple(values: np.ndarray) -> tuple[float, float, float]:
    """Three numbers of a vector."""
    x, y, z = (float(value) for value in values)
    return x, y, z

"""What determines a mesh beside the points: presets, and settings resolved from them."""

import math
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import torch
from torch import nn

from weingarten.errors import OptionError
from weingarten.method import Method
from weingarten.methods import METHODS, method_named
from weingarten.schedules.schedule import Knots
from weingarten.schedules.weight import weight_of

PLAIN = (str, int, float, bool)


@dataclass(frozen=True)
class Settings:
    """Every choice of a fit, resolved.

    Two fits with equal settings, points, device and number of threads give the same mesh.

    term: the one whose weight has this shape and these knots; all empty where none is scheduled.
    stencil: distances of the method's stencil over progress, unit lengths, if it has one.
    steps: optimisation steps. points: drawn per step on each domain, on average. ramp: times so many at the
    first step and at the last, in stages between. rate: learning rate at its greatest, times the cloud's pace
    (`weingarten.scan.pace`).
    decay: how the rate moves (fit.optimisers.RATES). clip: greatest norm of the gradient.
    width, depth, frequency: of the field, as far as the method's has them.
    resolution: cells along the longest side, or up to twice as many where walls and gaps are thin
    (`weingarten.surface.fineness`). sharp: whether vertices are put on sharp edges, and within the
    flat faces that bound the cloud. trim: distance from the points beyond which surface is left out, in the
    cloud's unit; 0 leaves out none. simplify: how far the surface may move so that it needs fewer triangles
    (`weingarten.surface.decimation`), in the cloud's unit; 0 keeps all triangles.
    """

    preset: str
    method: str
    term: str
    shape: str
    knots: Knots
    stencil: Knots
    seed: int
    steps: int
    points: int
    ramp: tuple[float, float]
    optimiser: str
    rate: float
    decay: str
    clip: float
    width: int
    depth: int
    frequency: float
    resolution: int
    sharp: bool
    trim: float
    simplify: float

    def resolved_method(self) -> Method:
        """The method's row with this fit's schedule and stencil."""
        row = method_named(self.method).with_step(self.stencil)
        return (
            row.scheduling(self.term).with_schedule(weight_of(self.shape, self.knots)) if self.term else row
        )

    def field(self, generator: torch.Generator | None = None) -> nn.Module:
        """The method's field at this fit's size, with first weights drawn from the generator."""
        return self.resolved_method().field(self.width, self.depth, self.frequency, generator)

    @property
    def notes(self) -> tuple[str, ...]:
        """What to know before the first step: weights that were made for another preset's optimiser."""
        made_for = method_named(self.method).made_for
        if not made_for or PRESETS[made_for].optimiser == self.optimiser:
            return ()
        return (
            f"The weights of {self.method} were made for --preset {made_for}, of smaller steps; "
            f"with {self.preset} its field may lose the part.",
        )

    def as_dict(self) -> dict[str, Any]:
        """Plain values, knots as [time, weight] pairs."""
        lists = {"knots": self.knots, "stencil": self.stencil}
        plain: dict[str, Any] = {name: [list(knot) for knot in knots] for name, knots in lists.items()}
        return asdict(self) | plain | {"ramp": list(self.ramp)}

    @classmethod
    def from_dict(cls, values: dict) -> "Settings":
        """The inverse of as_dict. Raises KeyError, TypeError, ValueError or OptionError for anything else."""
        known: dict[str, Any] = {
            field.name: plain(values[field.name], field.type) for field in fields(cls) if field.type in PLAIN
        }
        for name in ("knots", "stencil"):
            known[name] = tuple((float(time), float(value)) for time, value in values[name])
        known["ramp"] = (float(values["ramp"][0]), float(values["ramp"][1]))
        settings = cls(**known)
        settings.check()
        return settings

    def check(self) -> None:
        """Raise OptionError for a value out of range."""
        check_range("--seed", self.seed, 0, 2**63 - 1)
        check_range("--steps", self.steps, 1, 10_000_000)
        check_range("--points-per-step", self.points, 1, 10_000_000)
        check_range("--resolution", self.resolution, 8, 4096)
        check_range("The width of a field", self.width, 1, 4096)
        check_range("The depth of a field", self.depth, 1, 64)
        check_range("The weights of a field", self.width**2 * self.depth, 1, 1 << 27)
        if not 0.0 < self.frequency < math.inf:
            raise OptionError(f"The frequency of a field must be a positive number; got {self.frequency:g}.")
        if not 0.0 < self.rate <= 1.0:
            raise OptionError(f"--rate must be above 0 and at most 1; got {self.rate:g}.")


STANDARD = Settings(
    preset="standard",
    method="odw-oriented",
    term=METHODS["odw-oriented"].scheduled_term.name,
    shape="quintic",
    knots=METHODS["odw-oriented"].schedule.knots,
    stencil=(),
    seed=0,
    steps=800,
    points=1000,
    ramp=(0.4, 1.6),
    optimiser="muon",
    rate=5e-4,
    decay="cosine",
    clip=10.0,
    width=160,
    depth=5,
    frequency=30.0,
    resolution=256,
    sharp=True,
    trim=0.0,
    simplify=0.0,
)
FINE = replace(STANDARD, preset="fine", steps=1500, points=2000, width=256, resolution=512)
PAPER = replace(
    STANDARD,
    preset="paper",
    method="odw-paper",
    knots=METHODS["odw-paper"].schedule.knots,
    steps=10_000,
    points=20_000,
    ramp=(1.0, 1.0),
    optimiser="adam",
    rate=5e-5,
    decay="steady",
    width=256,
    sharp=False,
)

PRESETS = {settings.preset: settings for settings in (STANDARD, FINE, PAPER)}
"""A part in about half a minute on two cores; detailed parts; the settings of arXiv 2511.03147."""


def resolve(
    preset: str = "standard",
    method: str | None = None,
    schedule: str | None = None,
    knots: Knots | None = None,
    term: str | None = None,
    stencil: Knots | None = None,
    seed: int = 0,
    steps: int | None = None,
    points: int | None = None,
    resolution: int | None = None,
    sharp: bool | None = None,
    trim: float | None = None,
    simplify: float | None = None,
    rate: float | None = None,
) -> Settings:
    """Settings from a preset's name and what is to differ from it.

    schedule: a name of `schedules.schedule.SCHEDULES`, scaled to the method's greatest weight unless knots
    are given, or of `schedules.adaptive.ADAPTIVE`.
    knots: (time, weight) pairs; without a schedule's name they go with the method's own shape.
    term: the name of the term whose weight these are; by default the method's curvature term.
    stencil: (time, distance) pairs for a method by finite differences, unit lengths, linear between them.
    sharp: vertices on sharp edges, or marching cubes, which cuts them off.
    trim: leave out surface farther than this from all points, in the cloud's unit; the mesh is open then.
    simplify: let the surface move by so much, in the cloud's unit, for fewer triangles (extra `simplify`).
    rate: the learning rate at its greatest; by default the method's with the preset's optimiser, or the
    preset's.
    Raises OptionError for an unknown name or a value out of range.
    """
    if preset not in PRESETS:
        raise OptionError(f"There is no preset {preset!r}; choose one of {', '.join(PRESETS)}.")
    base = PRESETS[preset]
    row = method_named(method or base.method)
    row = row if term is None else row.scheduling(term)
    row = row if stencil is None else row.with_step(stencil)
    settings = replace(
        base,
        method=row.name,
        **scheduled(row, schedule, knots),
        stencil=row.step,
        seed=seed,
        rate=row.rates.get(base.optimiser, base.rate) if rate is None else rate,
        steps=base.steps if steps is None else steps,
        points=base.points if points is None else points,
        resolution=base.resolution if resolution is None else resolution,
        sharp=base.sharp if sharp is None else sharp,
        trim=base.trim if trim is None else check_length("--trim-distance", trim),
        simplify=base.simplify if simplify is None else check_length("--simplify", simplify),
    )
    settings.check()
    return settings


def scheduled(row: Method, schedule: str | None, knots: Knots | None) -> dict[str, Any]:
    """Which term's weight a fit schedules, and how: empty where the method schedules none and nobody asks."""
    if row.scheduled is None and schedule is None and knots is None:
        return {"term": "", "shape": "", "knots": ()}
    weight = row.schedule if schedule is None else row.named_schedule(schedule)
    if knots is not None:
        weight = weight_of(weight.shape, knots)
    return {"term": row.scheduled_term.name, "shape": weight.shape, "knots": weight.knots}


def plain(value: object, kind: type) -> object:
    """A value of this kind, a whole number where a float is wanted as one. Raises TypeError for another."""
    if kind is float and type(value) is int:
        return float(value)
    if type(value) is not kind:
        raise TypeError(f"{value!r} is no {kind.__name__}")
    return value


def check_length(name: str, length: float) -> float:
    """The length. Raises OptionError unless it is finite and not negative."""
    if not 0.0 <= length < math.inf:
        raise OptionError(f"{name} must be a positive number, or 0 for none; got {length:g}.")
    return length


def check_range(name: str, value: int, least: int, most: int) -> None:
    """Raise OptionError unless least ≤ value ≤ most."""
    if not least <= value <= most:
        raise OptionError(f"{name} must be between {least:,} and {most:,}; got {value:,}.")

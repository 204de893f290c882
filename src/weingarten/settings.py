"""What determines a mesh beside the points: presets, and settings resolved from them."""

from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import torch
from torch import nn

from weingarten.errors import OptionError
from weingarten.methods import METHODS, Method, method_named
from weingarten.schedules.schedule import Knots
from weingarten.schedules.weight import weight_of


@dataclass(frozen=True)
class Settings:
    """Every choice of a fit, resolved; two fits with equal settings, points and device give the same mesh.

    steps: optimisation steps. points: drawn per step on each domain, on average. ramp: times so many at the
    first step and at the last, in stages between. rate: learning rate at its greatest.
    decay: how the rate moves (fit.optimisers.RATES). clip: greatest norm of the gradient.
    width, depth, frequency: of the field, as far as the method's has them.
    resolution: cells along the longest side.
    """

    preset: str
    method: str
    shape: str
    knots: Knots
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

    def resolved_method(self) -> Method:
        """The method's row with this fit's schedule."""
        return method_named(self.method).with_schedule(weight_of(self.shape, self.knots))

    def field(self, generator: torch.Generator | None = None) -> nn.Module:
        """The method's field at this fit's size, with first weights drawn from the generator."""
        return self.resolved_method().field(self.width, self.depth, self.frequency, generator)

    def as_dict(self) -> dict[str, Any]:
        """Plain values, knots as [time, weight] pairs."""
        return asdict(self) | {"knots": [list(knot) for knot in self.knots], "ramp": list(self.ramp)}

    @classmethod
    def from_dict(cls, values: dict) -> "Settings":
        """The inverse of as_dict. Raises KeyError or TypeError for anything else."""
        known: dict[str, Any] = {field.name: values[field.name] for field in fields(cls)}
        known["knots"] = tuple((float(time), float(weight)) for time, weight in values["knots"])
        known["ramp"] = (float(values["ramp"][0]), float(values["ramp"][1]))
        return cls(**known)


STANDARD = Settings(
    preset="standard",
    method="odw",
    shape="quintic",
    knots=METHODS["odw"].schedule.knots,
    seed=0,
    steps=650,
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
)

PRESETS = {settings.preset: settings for settings in (STANDARD, FINE, PAPER)}
"""A part in about a quarter of a minute on two cores; detailed parts; arXiv 2511.03147 to the letter."""


def resolve(
    preset: str = "standard",
    method: str | None = None,
    schedule: str | None = None,
    knots: Knots | None = None,
    seed: int = 0,
    steps: int | None = None,
    points: int | None = None,
    resolution: int | None = None,
) -> Settings:
    """Settings from a preset's name and what is to differ from it.

    schedule: a name of schedules.SCHEDULES, scaled to the method's greatest weight unless knots are given.
    knots: (time, weight) pairs; without a schedule's name they go with the method's own shape.
    Raises OptionError for an unknown name or a value out of range.
    """
    if preset not in PRESETS:
        raise OptionError(f"There is no preset {preset!r}; choose one of {', '.join(PRESETS)}.")
    base = PRESETS[preset]
    row = method_named(method or base.method)
    weight = row.schedule if schedule is None else row.named_schedule(schedule)
    if knots is not None:
        weight = weight_of(weight.shape, knots)
    settings = replace(
        base,
        method=row.name,
        shape=weight.shape,
        knots=weight.knots,
        seed=seed,
        steps=base.steps if steps is None else steps,
        points=base.points if points is None else points,
        resolution=base.resolution if resolution is None else resolution,
    )
    check_range("--seed", settings.seed, 0, 2**63 - 1)
    check_range("--steps", settings.steps, 1, 10_000_000)
    check_range("--points-per-step", settings.points, 1, 10_000_000)
    check_range("--resolution", settings.resolution, 8, 4096)
    return settings


def check_range(name: str, value: int, least: int, most: int) -> None:
    """Raise OptionError unless least ≤ value ≤ most."""
    if not least <= value <= most:
        raise OptionError(f"{name} must be between {least:,} and {most:,}; got {value:,}.")

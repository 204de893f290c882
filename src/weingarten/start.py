"""What a fit begins with: a cleaned cloud in its frame, a field, draws, and the loop made of them."""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float64
from scipy.spatial import KDTree
from torch import nn

from weingarten.crew import crew_for
from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren
from weingarten.fit.captured import Captured, recorder
from weingarten.fit.checkpoint import Origin, fingerprint
from weingarten.fit.loop import CHUNK, GPU_CHUNK, Loop
from weingarten.fit.optimisers import OPTIMISERS, RATES
from weingarten.frame import Frame
from weingarten.scan.diagnose import diagnose
from weingarten.scan.doubts import doubts
from weingarten.scan.draws import REACH, CloudDraws, Draws
from weingarten.scan.generators import Generators
from weingarten.scan.noise import noise_level
from weingarten.scan.thinning import thinned, thinning_notes
from weingarten.settings import Settings

Points = Float64[np.ndarray, "n 3"]

MARGIN = 0.05
"""Room left around the cloud for the surface, unit lengths."""

LEAF = 32
"""Points in a leaf of the tree. With fewer, or with boxes drawn tight around them, distances from afar to
faces and bores take up to three times as long."""


@dataclass(frozen=True)
class Start:
    """One part before the first step of its fit.

    cloud: the points that are of use, world units; unit: those that the fit draws from, all or
    `weingarten.scan.thinning.thinned`, in the unit frame, moved towards their surface where they are noisy.
    generator: of the draws.
    noise: mean distance of the points from their surface, unit lengths. misfit: the same of those that the
    fit draws from, each as far as it counts.
    notes: what the user should know of the cloud and of the signs that free space gave. doubts: what speaks
    against a mesh of it, whatever comes out.
    """

    settings: Settings
    cloud: Points
    frame: Frame
    unit: Float64[np.ndarray, "m 3"]
    field: nn.Module
    draws: CloudDraws
    generator: torch.Generator
    noise: float
    misfit: float
    notes: tuple[str, ...]
    doubts: tuple[str, ...]

    @classmethod
    def of(
        cls, points: Points, settings: Settings, device: torch.device, module: nn.Module | None = None
    ) -> "Start":
        """From points in world units; `module` is fitted instead of a SIREN. Raises CloudError.

        First weights and the pool of signed points are drawn on the CPU, on every device the same; the draws
        of the steps are made on the GPU where that can.
        """
        method = settings.resolved_method()
        diagnosis = diagnose(np.asarray(points, dtype=np.float64))
        cloud, cleaning = method.preparation.cleaned(diagnosis.points, settings.seed)
        frame = Frame.of(cloud)
        given = frame.to_unit(thinned(cloud, settings.seed))
        settled = method.preparation.settle(given)
        generator = torch.Generator().manual_seed(settings.seed)
        field = settings.field(generator) if module is None else module
        tree = KDTree(settled.points, leafsize=LEAF, compact_nodes=False)
        draws, notes = method.knowledge(settled, tree, generator)
        draws.weight = settled.weight
        if module is None and isinstance(field, Siren):
            field.refine(draws.detail)
        if device.type == "cuda":
            draws.move(device)
            generator = torch.Generator(device).manual_seed(settings.seed)
        said = (*settings.notes, *diagnosis.notes, *cleaning, *thinning_notes(len(cloud), len(given)), *notes)
        noise = noise_level(given, tree if given is settled.points else KDTree(given))
        misfit = settled.misfit
        rims = tuple(frame.to_world(settled.points[rim]) for rim in settled.rims)
        against = doubts(settled.noise, draws.known, rims, frame.scale)
        return cls(
            settings,
            cloud,
            frame,
            settled.points,
            field.to(device),
            draws,
            generator,
            noise,
            noise if misfit is None else misfit,
            said,
            against,
        )

    def loop(self) -> Loop:
        """That of its fit alone, before the first step."""
        return loop_of(self.settings, self.field, self.draws, self.generator, self.misfit, self.draws.pace)

    @functools.cached_property
    def origin(self) -> Origin:
        """What a checkpoint of this fit belongs to."""
        return origin_of(self.settings, self.frame, self.cloud, self.draws.apart)


def loop_of(
    settings: Settings,
    field: nn.Module,
    draws: Draws,
    generator: torch.Generator | Generators,
    noise: float = 0.0,
    pace: float = 1.0,
) -> Loop:
    """The loop before its first step. noise: a start's misfit. pace: by what factor the rate is smaller.

    On CUDA its steps are recorded, if its field is a SIREN.
    """
    device = next(field.parameters()).device
    crew = crew_for(device)
    kind: Callable[..., Loop] = Loop
    if device.type == "cuda" and isinstance(field, Siren | Ensemble):
        kind = functools.partial(Captured, replay=recorder(generator))
    return kind(
        field=field,
        method=settings.resolved_method(),
        draws=draws,
        generator=generator,
        optimisers=OPTIMISERS[settings.optimiser](field),
        rate=RATES[settings.decay],
        base_rate=settings.rate * pace,
        steps=settings.steps,
        points=settings.points,
        clip=settings.clip,
        ramp=settings.ramp,
        chunk=CHUNK if device.type == "cpu" else GPU_CHUNK,
        crew=crew,
        seed=settings.seed,
        noise=noise,
    )


def origin_of(settings: Settings, frame: Frame, cloud: Points, apart: float) -> Origin:
    """What a checkpoint of this fit belongs to, and the box its surface is looked for in, from all points."""
    corners = frame.to_unit(np.stack([cloud.min(axis=0), cloud.max(axis=0)]))
    lower = np.maximum(corners[0] - MARGIN, -REACH)
    upper = np.minimum(corners[1] + MARGIN, REACH)
    return Origin(settings, frame, fingerprint(cloud), triple(lower), triple(upper), apart)


def triple(vector: Float64[np.ndarray, " 3"]) -> tuple[float, float, float]:
    """Three plain floats."""
    return float(vector[0]), float(vector[1]), float(vector[2])

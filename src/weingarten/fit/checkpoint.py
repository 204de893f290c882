"""The whole state of a fit in one file: weights, optimisers, generator, step, frame, settings.

Tensors go through safetensors, all else as JSON in its header; nothing in the file is ever executed.
"""

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float64
from safetensors import safe_open
from safetensors.torch import save as packed
from torch import Tensor

from weingarten.atomic import replacing
from weingarten.errors import CheckpointError
from weingarten.fit.loop import Loop
from weingarten.frame import Frame
from weingarten.io.reading import reading
from weingarten.settings import Settings
from weingarten.surface.fineness import cells_along

FORMAT = "weingarten-8"
EXTRACTION = ("resolution", "sharp", "trim", "simplify")
"""Settings that a fit may be resumed with otherwise: they are of its surface, not of its field."""

FARTHEST = 2.0
"""No box of a surface reaches so far, unit lengths."""

KEPT = "kept."
"""Prefix of weights kept for the mesh while the fit goes on with others (the oracle's)."""


@dataclass(frozen=True)
class Origin:
    """What a checkpoint belongs to: settings, frame, fingerprint of the points, box of the surface.

    apart: distance of the closest sheets of the surface, unit lengths.
    """

    settings: Settings
    frame: Frame
    fingerprint: str
    lower: tuple[float, float, float]
    upper: tuple[float, float, float]
    apart: float

    @property
    def cells(self) -> int:
        """Of the surface's lattice, along its longest side: those of the settings, more for thin walls."""
        sides = [high - low for low, high in zip(self.lower, self.upper, strict=True)]
        return cells_along(self.settings.resolution, max(sides), self.apart)


@dataclass(frozen=True)
class Checkpoint:
    """A checkpoint as read from its file.

    adaptive: what adaptive weights remember, by their terms' names. threads: that summed; 0 where not told.
    """

    origin: Origin
    step: int
    tensors: dict[str, Tensor]
    extra: dict[str, object]
    adaptive: dict[str, dict]
    threads: int = 0

    def field_state(self) -> dict[str, Tensor]:
        """The field's weights, for load_state_dict."""
        return prefixed(self.tensors, "field.")

    def kept_state(self) -> dict[str, Tensor]:
        """The weights kept for the mesh; empty where the last ones are meant."""
        return prefixed(self.tensors, KEPT)

    def restore(self, loop: Loop) -> None:
        """Bring a fresh loop of the same settings to this state: to the bit, if it has as many threads.

        Raises CheckpointError where the loop draws on another kind of device, or the state is another loop's.
        """
        state = self.tensors.get("generator", torch.empty(0))
        if state.shape != loop.generator.get_state().shape:
            raise CheckpointError(
                "The checkpoint was written on another kind of device; resume it with its own --device."
            )
        try:
            loop.field.load_state_dict(self.field_state())
            for index, optimiser in enumerate(loop.optimisers):
                optimiser.restore(prefixed(self.tensors, f"optimiser.{index}."))
            loop.generator.set_state(state)
            for name, own in loop.adaptive.items():
                own.restore(self.adaptive[name])
        except (KeyError, TypeError, ValueError, RuntimeError) as error:
            raise CheckpointError(
                "The checkpoint does not fit its own settings; delete it and start the fit anew."
            ) from error
        loop.step = self.step


def save(path: Path, loop: Loop, origin: Origin, extra_tensors: dict[str, Tensor], extra: dict) -> None:
    """Write the state of a fit; an earlier checkpoint at `path` stays until the new one is whole."""
    tensors = {f"field.{name}": value for name, value in loop.field.state_dict().items()}
    for index, optimiser in enumerate(loop.optimisers):
        tensors |= {f"optimiser.{index}.{name}": value for name, value in optimiser.state().items()}
    tensors["generator"] = loop.generator.get_state()
    tensors |= extra_tensors
    header = {
        "format": FORMAT,
        "step": loop.step,
        "settings": origin.settings.as_dict(),
        "frame": asdict(origin.frame),
        "fingerprint": origin.fingerprint,
        "lower": origin.lower,
        "upper": origin.upper,
        "apart": origin.apart,
        "threads": loop.crew.size,
        "extra": extra,
        "adaptive": {name: own.state() for name, own in loop.adaptive.items()},
    }
    # written here rather than by safetensors, whose error for a full disk is no OSError
    content = packed(
        separate(tensors),
        {"weingarten": json.dumps(header)},
    )
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def separate(tensors: dict[str, Tensor]) -> dict[str, Tensor]:
    """Copies on the CPU: safetensors takes none that share memory, as those of tied layers do."""
    return {name: value.detach().cpu().clone().contiguous() for name, value in tensors.items()}


def load(path: Path) -> Checkpoint:
    """Read a checkpoint. Raises CheckpointError when there is none, or it is corrupted or of another kind."""
    if not path.is_file():
        raise CheckpointError(f"There is no checkpoint at {path}; start the fit without --resume.")
    with reading(path, CheckpointError, "a checkpoint", "it is corrupted: delete it and start the fit anew"):
        with safe_open(path, framework="pt") as file:
            header = json.loads((file.metadata() or {})["weingarten"])
            # copies: the tensors are the file itself, and would go with it if somebody wrote into it
            tensors = {name: file.get_tensor(name).clone() for name in file.keys()}  # noqa: SIM118
        if header["format"] != FORMAT:
            raise CheckpointError(
                f"{path} is of format {header['format']!r}, not {FORMAT!r}; start the fit anew."
            )
        settings = Settings.from_dict(header["settings"])
        frame = Frame(triple(header["frame"]["centre"]), positive(header["frame"]["scale"], "its scale"))
        lower, upper = triple(header["lower"]), triple(header["upper"])
        if not all(-FARTHEST < low <= high < FARTHEST for low, high in zip(lower, upper, strict=True)):
            raise ValueError("its box is none")
        apart = positive(header["apart"], "its distance of sheets")
        origin = Origin(settings, frame, str(header["fingerprint"]), lower, upper, apart)
        extra, adaptive = dict(header["extra"]), dict(header["adaptive"])
        threads = int(header.get("threads", 0))
        return Checkpoint(origin, int(header["step"]), tensors, extra, adaptive, threads)


def triple(values: Sequence[float]) -> tuple[float, float, float]:
    """Three finite numbers; ValueError for anything else."""
    x, y, z = map(float, values)
    if not all(map(math.isfinite, (x, y, z))):
        raise ValueError("its coordinates are not finite")
    return x, y, z


def positive(value: float, name: str) -> float:
    """A finite number above zero; ValueError for anything else."""
    if not 0.0 < float(value) < math.inf:
        raise ValueError(f"{name} is not positive")
    return float(value)


def check_same(found: Origin, wanted: Origin) -> None:
    """Raise CheckpointError unless a checkpoint continues the fit that is asked for."""
    ours, theirs = wanted.settings.as_dict(), found.settings.as_dict()
    different = [name for name in ours if ours[name] != theirs[name] and name not in EXTRACTION]
    if different:
        listed = ", ".join(f"{name} {theirs[name]} there, {ours[name]} here" for name in different)
        raise CheckpointError(
            f"The checkpoint belongs to another configuration ({listed}); use another --run folder."
        )
    if found.fingerprint != wanted.fingerprint:
        raise CheckpointError("The checkpoint belongs to another cloud; use another --run folder.")


def prefixed(tensors: dict[str, Tensor], prefix: str) -> dict[str, Tensor]:
    """The entries whose name starts with `prefix`, without it."""
    return {name[len(prefix) :]: value for name, value in tensors.items() if name.startswith(prefix)}


def fingerprint(points: Float64[np.ndarray, "n 3"]) -> str:
    """A hash of the points' bytes."""
    return hashlib.sha256(np.ascontiguousarray(points).tobytes()).hexdigest()

"""A fitted field in the user's own coordinates."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float64
from torch import nn

from weingarten.calculus.choice import exact
from weingarten.calculus.jet import TANGENT
from weingarten.errors import CheckpointError
from weingarten.fit.checkpoint import Checkpoint
from weingarten.frame import Frame

BATCH = 4096


class FieldSample(NamedTuple):
    """The field at n points.

    distance: signed, negative inside, world units. gradient: no unit, outward near the surface.
    curvatures: κ₁ ≤ κ₂ of the level set, one over world unit; both 1/r on a sphere of radius r.
    """

    distance: Float64[np.ndarray, " n"]
    gradient: Float64[np.ndarray, "n 3"]
    curvatures: Float64[np.ndarray, "n 2"]


@dataclass(frozen=True)
class WorldField:
    """f in world units: `field(points)` for an (n, 3) array of world coordinates.

    module: the network in the unit frame. frame: between the two.
    """

    module: nn.Module
    frame: Frame

    @classmethod
    def of(cls, found: Checkpoint, device: torch.device) -> "WorldField":
        """The field of a checkpoint, with the weights kept for the mesh where there are such.

        Raises CheckpointError where the network is not that of the settings.
        """
        module = found.origin.settings.field()
        try:
            module.load_state_dict(found.kept_state() or found.field_state())
        except RuntimeError as error:
            raise CheckpointError(
                "The run was fitted with a network of its own; it can only be used in Python."
            ) from error
        return cls(module.to(device), found.origin.frame)

    def __call__(self, points: Float64[np.ndarray, "n 3"]) -> FieldSample:
        """Signed distance, gradient and principal curvatures at world points.

        The field is trained in the box of the cloud; far outside it, it means nothing.
        """
        calculus = exact(self.module)
        device = next(self.module.parameters()).device
        unit = torch.from_numpy(self.frame.to_unit(np.asarray(points, dtype=np.float64))).float().to(device)
        parts = []
        for piece in unit.split(BATCH):
            with torch.no_grad():
                jet = calculus(piece, TANGENT)
                s11, s12, s22 = jet.shape_operator
                mean, spread = 0.5 * (s11 + s22), torch.hypot(0.5 * (s11 - s22), s12)
                parts.append(
                    torch.cat(
                        [jet.value[:, None], jet.slope, (mean - spread)[:, None], (mean + spread)[:, None]],
                        dim=1,
                    )
                )
        values = torch.cat(parts).double().cpu().numpy() if parts else np.empty((0, 6))
        scale = self.frame.scale
        return FieldSample(values[:, 0] * scale, values[:, 1:4], values[:, 4:6] / scale)

"""The paper's early stopping: by the distance to the ground truth, which no real scan has.

Used only when a truth is given and asked for by name; its figures must not be compared with others'.
"""

from dataclasses import dataclass, field

import numpy as np
from torch import Tensor

from weingarten.errors import ExtractionError
from weingarten.fit.checkpoint import KEPT, Checkpoint, Origin
from weingarten.fit.loop import Loop
from weingarten.mesh import Mesh
from weingarten.metrics.protocol import PUBLISHED
from weingarten.surface.contour import extraction
from weingarten.surface.values import BATCH, field_values

EVERY = 100
PATIENCE = 1500
RESOLUTION = 128


@dataclass
class Oracle:
    """Watches the Chamfer distance (published protocol) to `truth`, world units, every 100 steps and last.

    Keeps the weights that came closest; says stop when the last 1,500 steps brought none that came closer.
    """

    truth: Mesh
    best: float = float("inf")
    best_step: int = 0
    weights: dict[str, Tensor] = field(default_factory=dict)

    def watch(self, loop: Loop, origin: Origin) -> bool:
        """True when the fit should stop here."""
        if loop.step == 0 or (loop.step % EVERY and loop.step < loop.steps):
            return False
        chamfer = self.chamfer(loop, origin)
        if chamfer < self.best:
            self.best, self.best_step = chamfer, loop.step
            self.weights = {name: value.clone() for name, value in loop.field.state_dict().items()}
        return loop.step - self.best_step >= PATIENCE

    def chamfer(self, loop: Loop, origin: Origin) -> float:
        """Of the present field's mesh; infinite where there is none."""
        try:
            values = field_values(loop.field, loop.crew)
            lower, upper = np.array(origin.lower), np.array(origin.upper)
            mesh = extraction(values, lower, upper, RESOLUTION, BATCH, loop.crew).mesh
        except ExtractionError:
            return float("inf")
        world = Mesh(origin.frame.to_world(mesh.vertices), mesh.faces)
        return PUBLISHED.evaluate(world, self.truth).chamfer

    def choose(self, loop: Loop) -> None:
        """Give the field the weights that came closest."""
        if self.weights:
            loop.field.load_state_dict(self.weights)

    def tensors(self) -> dict[str, Tensor]:
        """The kept weights, for the checkpoint."""
        return {f"{KEPT}{name}": value for name, value in self.weights.items()}

    def extra(self) -> dict[str, object]:
        """The rest of the state, for the checkpoint's header."""
        return {"oracle_best": self.best if self.weights else None, "oracle_step": self.best_step}

    def restore(self, found: Checkpoint) -> None:
        """Go on from a checkpoint."""
        best = found.extra.get("oracle_best")
        if isinstance(best, float):
            self.best, self.best_step = best, int(str(found.extra["oracle_step"]))
            self.weights = found.kept_state()

"""Training seconds until a fit is good, and stays so: the exact tangent block against finite differences.

    python benchmarks/quality.py [--parts flange bracket] [--thresholds 2e-3 1e-3 5e-4] [--every 50]

Each part's fits (standard preset, 30,000 points) take turns of --every steps. After a turn the clock stands
still while the mesh is extracted and compared with the true part, protocol `exact`: Chamfer distance in
unit-cube lengths. A threshold is reached when this and all later meshes are below it.
"""

import argparse
import sys
import time
from dataclasses import dataclass, field

import torch
from table import table

from weingarten.cli.memory import keep_freed_memory
from weingarten.errors import ExtractionError
from weingarten.fit.checkpoint import Origin
from weingarten.fit.loop import Loop
from weingarten.mesh import Mesh
from weingarten.metrics.protocol import EXACT
from weingarten.reconstruction import Points, surface
from weingarten.samples.parts import PARTS, part_mesh, sample_part
from weingarten.settings import resolve
from weingarten.start import Start

METHODS = ("odw", "odw-fd")
POINTS, RESOLUTION = 30_000, 128


@dataclass
class Trial:
    """One fit. seconds: of training so far. curve: seconds and Chamfer distance after every turn."""

    loop: Loop
    origin: Origin
    unit: Points
    seconds: float = 0.0
    curve: list[tuple[float, float]] = field(default_factory=list)

    @classmethod
    def of(cls, part: str, method: str, steps: int | None) -> "Trial":
        """Before its first step."""
        settings = resolve("standard", method=method, steps=steps, resolution=RESOLUTION, sharp=False)
        start = Start.of(sample_part(part, POINTS, 0), settings, torch.device("cpu"))
        return cls(start.loop(), start.origin, start.unit)

    @property
    def finished(self) -> bool:
        """Whether all steps are taken."""
        return self.loop.step >= self.loop.steps

    def turn(self, steps: int, truth: Mesh) -> None:
        """Take up to so many steps, then stop the clock and measure."""
        started = time.perf_counter()
        with self.loop.crew:
            for _ in range(min(steps, self.loop.steps - self.loop.step)):
                self.loop.advance()
        self.seconds += time.perf_counter() - started
        self.curve.append((self.seconds, self.chamfer(truth)))

    def chamfer(self, truth: Mesh) -> float:
        """Of the present field's mesh; infinite where there is none."""
        try:
            mesh, _ = surface(self.loop.field, self.origin, self.unit, self.loop.crew)
        except ExtractionError:
            return float("inf")
        return EXACT.evaluate(Mesh(self.origin.frame.to_world(mesh.vertices), mesh.faces), truth).chamfer

    def reached(self, threshold: float) -> float:
        """Training seconds after which the distance stays below; infinite where it does not."""
        found = float("inf")
        for seconds, chamfer in reversed(self.curve):
            if chamfer >= threshold:
                break
            found = seconds
        return found


def trials(part: str, truth: Mesh, every: int, steps: int | None) -> list[Trial]:
    """A part's fits, one for each method, to their end."""
    found = [Trial.of(part, method, steps) for method in METHODS]
    while not all(trial.finished for trial in found):
        for trial in found:
            trial.turn(every, truth)
    return found


def rows(part: str, arguments: argparse.Namespace) -> list[list[str]]:
    """A part's rows: one for each threshold, and one for the end of the fit."""
    truth = part_mesh(part)
    best = EXACT.evaluate(part_mesh(part, RESOLUTION), truth).chamfer
    found = trials(part, truth, arguments.every, arguments.steps)
    cells: list[list[str]] = []
    for threshold in sorted(arguments.thresholds, reverse=True):
        cells.append([f"{part}, {threshold:g}", *compared([trial.reached(threshold) for trial in found])])
    cells.append([f"{part}, all steps", *compared([trial.seconds for trial in found])])
    last = [f"{trial.curve[-1][1]:.2e}" for trial in found]
    return [*cells, [f"{part}, distance at the end (true part at {RESOLUTION}: {best:.2e})", *last, ""]]


def compared(seconds: list[float]) -> list[str]:
    """Times, and the last over the first; a dash where there is none."""
    times = [f"{value:.1f}" if value < float("inf") else "–" for value in seconds]
    return [*times, f"{seconds[-1] / seconds[0]:.2f}" if "–" not in times else "–"]


def main() -> None:
    """Parse, fit, write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=["flange", "bracket"])
    parser.add_argument("--thresholds", nargs="+", type=float, default=[2e-3, 1e-3, 5e-4])
    parser.add_argument("--every", type=int, default=50, help="steps between two meshes (default 50)")
    parser.add_argument("--steps", type=int, help="of a fit (default: the preset's)")
    arguments = parser.parse_args()
    keep_freed_memory()
    found = [row for part in arguments.parts for row in rows(part, arguments)]
    heading = (
        f"Training seconds to a Chamfer distance, measured every {arguments.every} steps at {RESOLUTION}"
    )
    sys.stdout.write(f"{heading}\n{table(['', *METHODS, 'ratio'], found)}")


if __name__ == "__main__":
    main()

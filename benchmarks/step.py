"""Seconds and memory of one step of the `paper` preset: this engine, the stencil, plain double backward.

    python benchmarks/step.py [--points 20000] [--steps 3] [--baseline]

Each runs in a process of its own, so that its peak memory is its own; they take their steps in turn, so that
whatever else the machine does falls on all of them alike. The limit is the step's arithmetic, 21 passes of
0.526 MFLOP a point (design notes, findings), at the fastest float32 matrix product seen on this machine.
"""

import argparse
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from statistics import median

CONTENDERS = {
    "engine": "this engine (odw-paper)",
    "stencil": "finite differences (odw-paper-fd)",
    "baseline": "plain double backward, unchunked",
}
MEGAFLOP_A_POINT, PASSES = 0.526, 21
KIBIBYTES = 1 / 1024 if sys.platform == "darwin" else 1.0


def stepper(name: str, points: int) -> Callable[[], None]:
    """One step of a contender on the bundled flange, 30,000 points."""
    import torch
    from scipy.spatial import KDTree

    from weingarten.fields.siren import Siren
    from weingarten.fit.loop import Loop
    from weingarten.fit.optimisers import adam, steady
    from weingarten.frame import Frame
    from weingarten.methods import METHODS
    from weingarten.samples.parts import sample_part
    from weingarten.scan.draws import CloudDraws

    scan = sample_part("flange", 30_000, 0)
    unit = Frame.of(scan).to_unit(scan)
    draws, generator = CloudDraws(unit, KDTree(unit)), torch.Generator().manual_seed(0)
    if name == "baseline":
        from double_backward import DoubleBackward

        plain = DoubleBackward()

        def step() -> None:
            samples = [sample.points for sample in draws(points, generator).values()]
            plain.step(*samples, 2 * torch.pi * torch.rand(points, generator=generator), 10.0)

        return step
    field = Siren(generator=generator)
    method = METHODS["odw-paper" if name == "engine" else "odw-paper-fd"]
    loop = Loop(field, method, draws, generator, adam(field, 5e-5), steady, 5e-5, 10_000, points, 10.0)
    return lambda: void(loop.advance())


def void(_: object) -> None:
    """Nothing."""


def serve(name: str, points: int) -> None:
    """Answer every line on standard input with a step's seconds and the peak memory in MiB."""
    from weingarten.cli.memory import keep_freed_memory

    keep_freed_memory()
    step = stepper(name, points)
    for _ in sys.stdin:
        started = time.perf_counter()
        step()
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * KIBIBYTES / 1024
        sys.stdout.write(f"{time.perf_counter() - started} {peak}\n")
        sys.stdout.flush()


def contend(names: list[str], points: int, steps: int) -> dict[str, tuple[float, float]]:
    """Median seconds a step, and peak memory in MiB, of each; the first step is not counted."""
    command = [sys.executable, __file__, "--points", str(points), "--serve"]
    processes = {
        name: subprocess.Popen([*command, name], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for name in names
    }
    seen: dict[str, list[tuple[float, float]]] = {name: [] for name in names}
    for _ in range(steps + 1):
        for name, process in processes.items():
            assert process.stdin is not None
            assert process.stdout is not None
            process.stdin.write("step\n")
            process.stdin.flush()
            answer = process.stdout.readline().split()
            if len(answer) != 2:
                raise SystemExit(f"The process of {name} ended early, with code {process.wait()}.")
            seen[name].append((float(answer[0]), float(answer[1])))
    for process in processes.values():
        process.communicate()
    return {name: (median(s for s, _ in rows[1:]), rows[-1][1]) for name, rows in seen.items()}


def matrix_peak() -> tuple[float, str]:
    """The most GFLOP/s of a float32 matrix product, over libraries and sizes, and which it was."""
    import torch

    from weingarten.calculus.product import ONEDNN, product

    libraries = {"torch.mm": torch.mm} | ({"oneDNN": product} if ONEDNN else {})
    best = (0.0, "")
    for rows, inner in ((256, 256), (1024, 256), (4096, 256), (512, 512), (1024, 1024), (2048, 2048)):
        a, b = torch.rand(rows, inner), torch.rand(inner, inner)
        for library, multiply in libraries.items():
            seconds = min(timed(lambda m=multiply, a=a, b=b: void(m(a, b))) for _ in range(12))
            speed = 2e-9 * rows * inner * inner / seconds
            best = max(best, (speed, f"{library}, {rows}×{inner}×{inner}"))
    return best


def timed(work: Callable[[], None]) -> float:
    """Seconds of one call, the mean over enough of them to fill about 10 ms."""
    work()
    count, started = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - started) < 0.01:
        work()
        count += 1
    return elapsed / count


def table(results: dict[str, tuple[float, float]], points: int) -> str:
    """The one table."""
    import torch

    peak, where = matrix_peak()
    limit = PASSES * MEGAFLOP_A_POINT * points / 1e3 / peak
    engine = results["engine"][0]
    lines = [
        f"One paper step, {points:,} points of each kind, {torch.get_num_threads()} threads, "
        f"torch {torch.__version__}",
        f"{'':36s} {'s/step':>9s} {'× engine':>9s} {'× limit':>9s} {'peak MiB':>9s}",
    ]
    for name, (seconds, memory) in results.items():
        ratios = f"{seconds / engine:9.2f} {seconds / limit:9.2f}"
        lines.append(f"{CONTENDERS[name]:36s} {seconds:9.4f} {ratios} {memory:9,.0f}")
    lines.append(f"{'arithmetic limit':36s} {limit:9.4f} {limit / engine:9.2f} {1:9.2f}")
    lines.append(f"fastest float32 product: {peak:.0f} GFLOP/s ({where})")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Parse, measure, write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=20_000, help="points of each kind (default 20000)")
    parser.add_argument("--steps", type=int, default=3, help="steps timed, beside one to warm up (default 3)")
    parser.add_argument("--baseline", action="store_true", help="time plain double backward too (~5 GB)")
    parser.add_argument("--serve", choices=CONTENDERS, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.serve:
        serve(arguments.serve, arguments.points)
        return
    names = [name for name in CONTENDERS if name != "baseline" or arguments.baseline]
    sys.stdout.write(table(contend(names, arguments.points, arguments.steps), arguments.points))


if __name__ == "__main__":
    main()

"""The fastest float32 matrix product of this machine: what the step's arithmetic is measured against."""

import time
from collections.abc import Callable

import torch
from torch import Tensor

from weingarten.calculus import kernels
from weingarten.crew import crew_for

SIZES = ((256, 256), (1024, 256), (4096, 256), (512, 512), (1024, 1024), (2048, 2048))
ROUNDS, LEAST_SECONDS = 12, 0.01
Multiply = Callable[[Tensor, Tensor], Tensor]


def matrix_peak() -> tuple[float, str]:
    """The most GFLOP/s over libraries, sizes and ways of using the cores, and which it was."""
    libraries: dict[str, Multiply] = {"torch.mm": torch.mm, "weingarten's panels": panels}
    if torch.backends.mkldnn.is_available() and hasattr(torch.ops.mkldnn, "_linear_pointwise"):
        libraries["oneDNN"] = onednn
    best = (0.0, "")
    for rows, inner in SIZES:
        for library, multiply in libraries.items():
            for way, speed in (("all cores on one", together), ("one on each core", apart)):
                found = speed(multiply, rows, inner)
                best = max(best, (found, f"{library}, {rows}×{inner}×{inner}, {way}"))
    return best


def panels(a: Tensor, b: Tensor) -> Tensor:
    """The product that a fit on the CPU is made of."""
    out = a.new_empty(len(a), b.shape[1])
    kernels.product(a.numpy(), b.numpy(), out.numpy(), b.shape[1])
    return out


def onednn(a: Tensor, b: Tensor) -> Tensor:
    """The product of torch's other library, which torch.mm does not use."""
    return torch.ops.mkldnn._linear_pointwise(a, b.t(), None, "none", [], "")


def together(multiply: Multiply, rows: int, inner: int) -> float:
    """GFLOP/s of one product at a time."""
    a, b = torch.rand(rows, inner), torch.rand(inner, inner)
    return 2e-9 * rows * inner * inner / fastest(lambda: multiply(a, b))


def apart(multiply: Multiply, rows: int, inner: int) -> float:
    """GFLOP/s of as many products as there are cores, as a fit does them; each repeated to about a ms."""
    a, b = torch.rand(rows, inner), torch.rand(inner, inner)
    crew = crew_for(torch.device("cpu"))
    repeats = max(1, round(2e8 / (rows * inner * inner)))

    def work(_: int) -> None:
        for _ in range(repeats):
            multiply(a, b)

    with crew:
        seconds = fastest(lambda: crew.map(work, range(crew.size)))
    return 2e-9 * rows * inner * inner * repeats * crew.size / seconds


def fastest(work: Callable[[], object]) -> float:
    """Seconds of one call: the least, over rounds, of the mean of a round."""
    work()
    return min(mean_seconds(work) for _ in range(ROUNDS))


def mean_seconds(work: Callable[[], object]) -> float:
    """Seconds of one call, the mean over enough of them to fill a round."""
    count, started = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - started) < LEAST_SECONDS:
        work()
        count += 1
    return elapsed / count

"""Muon: momentum brought near to an orthogonal matrix before it is applied (Jordan et al. 2024).

With momentum M ← μM + G and, after Nesterov, the update U = G + μM,

    W ← W − 0.2 √max(rows, columns) · lr · polar(U),   polar(U) = (UUᵀ)^(−1/2) U,

which has the root mean square of an update of Adam (Liu et al. 2025, eq. 4). `torch.optim.Muon` is the same
method in bfloat16, which processors without that arithmetic emulate: with AVX2, 0.65 s a step of the standard
preset, many times as long as the rest of it. Here all is float32.
"""

import functools
import math
from collections.abc import Callable, Iterable

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus import kernels
from weingarten.fit.optimiser import Factor, Optimiser

A, B, C, TIMES = 3.4445, -4.7750, 2.0315, 5
COEFFICIENTS = np.float32(A), np.float32(B), np.float32(C)
"""x ← Ax + Bx³ + Cx⁵, so often: singular values from 10⁻³ to 1 end in 0.46 … 1.21 (Jordan et al. 2024).
Exact polar factors, which are larger, made worse meshes (docs/performance.md)."""


class Muon(Optimiser):
    """For matrices, and ensembles of them, alone; see Optimiser. momentum: μ."""

    def __init__(self, matrices: Iterable[Tensor], momentum: float = 0.95) -> None:
        self.matrices = list(matrices)
        self.momenta = [torch.zeros_like(matrix) for matrix in self.matrices]
        self.momentum = momentum

    @property
    def size(self) -> int:
        """One for each matrix."""
        return len(self.matrices)

    def factors(self, rate: float) -> tuple[float, ...]:
        """−0.2 √max(rows, columns) · lr of every matrix."""
        return tuple(-0.2 * math.sqrt(max(matrix.shape[-2:])) * rate for matrix in self.matrices)

    def jobs(self, *factors: Factor) -> list[Callable[[], None]]:
        """See Optimiser: one for each matrix."""
        rows = zip(self.matrices, self.momenta, factors, strict=True)
        return [functools.partial(self.descend, *row) for row in rows if row[0].grad is not None]

    @torch.no_grad()
    def descend(self, matrix: Tensor, kept: Tensor, factor: Factor) -> None:
        """Move one matrix, which has a gradient."""
        assert matrix.grad is not None
        if all(kernels.whole_panels(tensor) for tensor in (matrix, matrix.grad, kept)):
            arrays = (tensor.detach().numpy() for tensor in (matrix, matrix.grad, kept))
            kernels.descend(*arrays, np.float32(self.momentum), np.float32(factor), COEFFICIENTS, TIMES)
            torch.autograd.graph.increment_version(matrix)
            return
        kept.mul_(self.momentum).add_(matrix.grad)
        update = polar(matrix.grad.add(kept, alpha=self.momentum))
        matrix.addcmul_(update, torch.as_tensor(factor, dtype=update.dtype, device=update.device))

    def state(self) -> dict[str, Tensor]:
        """The momenta."""
        return {f"momentum.{i}": kept for i, kept in enumerate(self.momenta)}

    def restore(self, state: dict[str, Tensor]) -> None:
        """The inverse of `state`."""
        for i, kept in enumerate(self.momenta):
            kept.copy_(state[f"momentum.{i}"])


def polar(matrix: Float[Tensor, "*batch n m"]) -> Float[Tensor, "*batch n m"]:
    """U Vᵀ of the singular value decomposition U S Vᵀ, roughly: singular values end around 0.9 instead of 1.

    Those below a thousandth of the Frobenius norm stay smaller. Zero for a zero matrix.
    """
    x = matrix / matrix.norm(dim=(-2, -1), keepdim=True).clamp_min(torch.finfo(matrix.dtype).tiny)
    for _ in range(TIMES):
        gram = x @ x.mT
        polynomial = (gram @ gram).mul_(C).add_(gram, alpha=B)
        x = (polynomial @ x).add_(x, alpha=A)
    return x

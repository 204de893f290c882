"""Gradients of bounded norm: `torch.nn.utils.clip_grad_norm_`, but for every part of an ensemble by itself.

g ← g · min(1, most / (‖g‖ + 10⁻⁶)),   ‖g‖ over all of a part's weights
"""

from collections.abc import Sequence

import torch
from torch import Tensor

GUARD = 1e-6


def clip(gradients: Sequence[Tensor], most: float, batch: int) -> None:
    """Shorten gradients in place; their first `batch` dimensions count parts, each with a norm of its own.

    A part whose gradient is not finite, or too great to be squared, is left with one that is not finite, and
    no other part knows of it.
    """
    if not gradients:
        return
    norms = [torch.linalg.vector_norm(gradient.flatten(batch), dim=-1) for gradient in gradients]
    norm = torch.linalg.vector_norm(torch.stack(norms), dim=0)
    factor = torch.where(norm.isfinite(), (most / (norm + GUARD)).clamp(max=1.0), torch.nan)
    for gradient in gradients:
        gradient.mul_(factor.view((*factor.shape, *[1] * (gradient.dim() - batch))))

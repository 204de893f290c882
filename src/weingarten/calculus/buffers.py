"""Working memory handed out again and again.

Fresh megabytes cost a page fault every four kilobytes: a third of a training step where the C library
returns freed memory to the system (findings, "Cost of one optimisation step").
"""

from collections import defaultdict

import torch
from torch import Tensor


class Buffers:
    """A free list of tensors by shape, type and device; their content is whatever was left in them."""

    def __init__(self) -> None:
        self.free: defaultdict[tuple[tuple[int, ...], torch.dtype, torch.device], list[Tensor]] = defaultdict(
            list
        )

    def take(self, like: Tensor, *shape: int) -> Tensor:
        """An uninitialised tensor of `shape`, of the type and on the device of `like`."""
        shelf = self.free[shape, like.dtype, like.device]
        return shelf.pop() if shelf else like.new_empty(shape)

    def give_back(self, *tensors: Tensor) -> None:
        """Return tensors that nothing refers to any more."""
        for tensor in tensors:
            self.free[tuple(tensor.shape), tensor.dtype, tensor.device].append(tensor)

"""Working memory handed out again and again.

Fresh megabytes cost a page fault every four kilobytes: a third of a training step where the C library
returns freed memory to the system (findings, "Cost of one optimisation step").
"""

import torch
from torch import Tensor

Kind = tuple[tuple[int, ...], torch.dtype, torch.device]


class Buffers:
    """A free list of tensors by shape, type and device; their content is whatever was left in them.

    Threads may share it: setdefault, pop and append are each one indivisible operation.
    """

    def __init__(self) -> None:
        self.free: dict[Kind, list[Tensor]] = {}

    def take(self, like: Tensor, *shape: int) -> Tensor:
        """An uninitialised tensor of `shape`, of the type and on the device of `like`."""
        try:
            return self.free.setdefault((shape, like.dtype, like.device), []).pop()
        except IndexError:
            return like.new_empty(shape)

    def give_back(self, *tensors: Tensor) -> None:
        """Return tensors that nothing refers to any more."""
        for tensor in tensors:
            self.free.setdefault((tuple(tensor.shape), tensor.dtype, tensor.device), []).append(tensor)

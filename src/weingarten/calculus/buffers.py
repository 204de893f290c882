"""Working memory handed out again and again.

Fresh megabytes cost a page fault every four kilobytes: a third of a training step where the C library
returns freed memory to the system.
"""

import math

import torch
from torch import Tensor

Kind = tuple[int, torch.dtype, torch.device]


class Buffers:
    """A free list of memory by size, type and device; its content is whatever was left in it.

    Sizes are powers of two, so that steps with more and more points do not each leave their own behind; what
    a tensor does not use of its memory is never touched, and so costs nothing. Threads may share the list:
    setdefault, pop and append are each one indivisible operation.
    """

    def __init__(self) -> None:
        self.free: dict[Kind, list[Tensor]] = {}

    def take(self, like: Tensor, *shape: int) -> Tensor:
        """An uninitialised tensor of `shape`, of the type and on the device of `like`."""
        count = math.prod(shape)
        size = capacity(count)
        shelf = self.free.setdefault((size, like.dtype, like.device), [])
        try:
            memory = shelf.pop()
        except IndexError:
            memory = like.new_empty(size)
        return memory[:count].view(shape)

    def give_back(self, *tensors: Tensor) -> None:
        """Return tensors that nothing refers to any more."""
        for tensor in tensors:
            size = capacity(tensor.numel())
            memory = tensor.as_strided((size,), (1,), 0)
            self.free.setdefault((size, tensor.dtype, tensor.device), []).append(memory)


def capacity(count: int) -> int:
    """The power of two at or above `count`."""
    return 1 << max(0, count - 1).bit_length()

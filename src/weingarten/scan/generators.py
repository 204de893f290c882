"""The random generators of many parts as one, so that each part draws what it would draw alone."""

from collections.abc import Sequence

import torch
from jaxtyping import UInt8
from torch import Tensor


class Generators:
    """m generators, in the place of the one that a single fit has; all on one device."""

    def __init__(self, members: Sequence[torch.Generator]) -> None:
        self.members = list(members)

    def get_state(self) -> UInt8[Tensor, "m bytes"]:
        """That of each."""
        return torch.stack([member.get_state() for member in self.members])

    def set_state(self, state: UInt8[Tensor, "m bytes"]) -> None:
        """The inverse of `get_state`."""
        for member, own in zip(self.members, state, strict=True):
            member.set_state(own.clone())

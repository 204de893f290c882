"""What a term may know about the points it is evaluated at, beside the field."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import torch
from jaxtyping import Float
from torch import Tensor

DOMAINS = SURFACE, OFF_SURFACE, NEAR = "surface", "off-surface", "near-surface"
"""Where points are drawn: on the cloud; in the box; on the cloud plus a Gaussian."""


@dataclass(frozen=True)
class Sample:
    """Points of one domain in the unit frame; of m parts drawn together, row k holds the k-th point of each.

    distance: signed distance known from free space, NaN where nothing is known; None on other domains.
    angles: by which tangent frames are turned, radians; None where no frame will be asked for.
    unsigned: distance to the nearest point of the cloud, unit lengths; None where it was not worked out.
    normals: outward, as long as they are to be trusted, from 0 to 1; None where they were not estimated.
    weight: what a point counts in the data term, at most 1; None where all count fully.
    progress: t = step / steps of the step that they were drawn for, where a term asks for it; else 0.
    """

    points: Float[Tensor, "n *m 3"]
    distance: Float[Tensor, "n *m"] | None = None
    angles: Float[Tensor, "n *m"] | None = None
    unsigned: Float[Tensor, "n *m"] | None = None
    normals: Float[Tensor, "n *m 3"] | None = None
    weight: Float[Tensor, "n *m"] | None = None
    progress: float = 0.0

    @property
    def turns(self) -> Float[Tensor, "n *m"]:
        """The angles, zero where none were drawn."""
        return self.points.new_zeros(self.points.shape[:-1]) if self.angles is None else self.angles

    @property
    def weights(self) -> Float[Tensor, "n *m"]:
        """What points count, 1 where nothing is said."""
        return self.points.new_ones(self.points.shape[:-1]) if self.weight is None else self.weight

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, rows: slice) -> "Sample":
        """The points of a slice."""
        return self.each(lambda tensor: tensor[rows])

    def split(self, size: int) -> "list[Sample]":
        """The same points in consecutive pieces of at most `size`."""
        return [self[start : start + size] for start in range(0, len(self), size)]

    def to(self, device: torch.device) -> "Sample":
        """The same sample on another device."""
        return self.each(lambda tensor: tensor.to(device))

    def each(self, change: Callable[[Tensor], Tensor]) -> "Sample":
        """The sample of changed tensors."""
        return replace(self, **{name: change(tensor) for name, tensor in self.tensors.items()})

    @property
    def tensors(self) -> dict[str, Tensor]:
        """What is known, by name."""
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        return {name: value for name, value in values.items() if isinstance(value, Tensor)}

"""What a term may know about the points it is evaluated at, beside the field."""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor

SURFACE, OFF_SURFACE, NEAR = "surface", "off-surface", "near-surface"
"""Where points are drawn: on the cloud; uniformly in the box; on the cloud plus a Gaussian (method §1)."""


@dataclass(frozen=True)
class Sample:
    """Points of one domain in the unit frame.

    distance: signed distance known from free space, NaN where nothing is known; None on other domains.
    """

    points: Float[Tensor, "n 3"]
    distance: Float[Tensor, " n"] | None = None

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, rows: slice) -> "Sample":
        """The points of a slice."""
        return Sample(self.points[rows], None if self.distance is None else self.distance[rows])

    def split(self, size: int) -> "list[Sample]":
        """The same points in consecutive pieces of at most `size`."""
        points = self.points.split(size)
        distances = [None] * len(points) if self.distance is None else self.distance.split(size)
        return [Sample(p, d) for p, d in zip(points, distances, strict=True)]

    def to(self, device: torch.device) -> "Sample":
        """The same sample on another device."""
        return Sample(self.points.to(device), None if self.distance is None else self.distance.to(device))

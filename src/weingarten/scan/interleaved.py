"""The draws of many parts as one: row k of a sample holds the k-th point of each."""

from collections.abc import Sequence
from dataclasses import replace

import torch

from weingarten.scan.draws import Draws
from weingarten.scan.generators import Generators
from weingarten.scan.sample import Sample


class Interleaved:
    """Draws of m parts, all knowing the same about their points but for weights; see `scan.draws.Draws`."""

    def __init__(self, members: Sequence[Draws]) -> None:
        self.members = list(members)

    def __call__(self, count: int, generator: Generators) -> dict[str, Sample]:
        """The samples of one step, (count, m) points of each domain; member i draws with generator i."""
        pairs = zip(self.members, generator.members, strict=True)
        drawn = [draws(count, own) for draws, own in pairs]
        return {name: side_by_side([samples[name] for samples in drawn]) for name in drawn[0]}


def side_by_side(samples: Sequence[Sample]) -> Sample:
    """Equally many points of each of m parts as (n, m) points."""
    if any(sample.weight is not None for sample in samples):
        samples = [replace(sample, weight=sample.weights) for sample in samples]
    rows = [sample.tensors for sample in samples]
    return replace(samples[0], **{name: torch.stack([row[name] for row in rows], dim=1) for name in rows[0]})

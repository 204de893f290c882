"""A multiresolution hash grid with a small network on top (Instant-NGP, Müller et al. 2022), in plain torch.

Level l has a grid of N_l = ⌊N₀ bˡ⌋ cells a side over the box. At each of its corners lies a feature vector,
in a table of at most 2^T rows: coarse levels have a row of their own for every corner, fine ones share rows
by

    h(i, j, k) = (i ⊕ 2654435761 j ⊕ 805459861 k) mod 2^T                                    (eq. 4)

Features are interpolated trilinearly within a cell; those of all levels and the point itself are the input
of one softplus layer, f. The features are next to zero and the layer a sphere's distance at first, as in
Neuralangelo.

Within a cell the features are trilinear: along its axes their second derivatives are zero, and gradients
jump from cell to cell. So curvature has to be taken by finite differences, over a cell at least:
`weingarten.calculus.choice.Differences` with `central_gradients`.
"""

import torch
from jaxtyping import Float, Int64
from torch import Tensor, nn

from weingarten.fields.softplus import SHARPNESS
from weingarten.fields.sphered import fibonacci

PRIMES = (1, 2654435761, 805459861)
REACH = 1.1
"""Half side of the box, unit lengths; points beyond are taken at its border."""

FIRST = 1e-4
"""Features begin uniform within ±this (section 4)."""


class HashGrid(nn.Module):
    """f: (n, 3) → (n,), ‖x‖ − radius at first.

    levels, features: of the encoding. coarsest, finest: cells along a side of the first and the last level.
    table: 2-logarithm of the most rows a level has. width: units of the layer on top, even.
    radius: unit lengths.
    """

    resolutions: list[int]
    corners: Tensor

    def __init__(
        self,
        levels: int = 10,
        features: int = 2,
        coarsest: int = 8,
        finest: int = 256,
        table: int = 16,
        width: int = 64,
        radius: float = 1.0,
        generator: torch.Generator | None = None,
    ) -> None:
        super().__init__()
        growth = (finest / coarsest) ** (1.0 / max(1, levels - 1))
        self.resolutions = [int(coarsest * growth**level + 1e-6) for level in range(levels)]
        counts = [min(2**table, (cells + 1) ** 3) for cells in self.resolutions]
        self.tables = nn.ParameterList(
            nn.Parameter(FIRST * (2.0 * torch.rand(count, features, generator=generator) - 1.0))
            for count in counts
        )
        self.network = Encoded(levels * features, width, radius, generator)
        corners = torch.tensor([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
        self.register_buffer("corners", corners, persistent=False)

    def cell(self, level: int) -> float:
        """Side of a level's cells, unit lengths."""
        return 2.0 * REACH / self.resolutions[level]

    def forward(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """Field values at points of the unit frame."""
        where = ((points.clamp(-REACH, REACH) / REACH) + 1.0) / 2.0
        levels = zip(self.resolutions, self.tables, strict=True)
        encoded = [self.interpolated(where * cells, cells, table) for cells, table in levels]
        return self.network(points, torch.cat(encoded, dim=-1))

    def interpolated(
        self, at: Float[Tensor, "n 3"], cells: int, table: Float[Tensor, "rows features"]
    ) -> Float[Tensor, "n features"]:
        """A level's features at points in units of its cells."""
        low = at.detach().floor().clamp(0, cells - 1)
        within = (at - low).unsqueeze(1)
        corner = low.long().unsqueeze(1) + self.corners
        shares = torch.where(self.corners.bool(), within, 1.0 - within).prod(dim=-1, keepdim=True)
        return (shares * table[rows(corner, cells, len(table))]).sum(dim=1)


class Encoded(nn.Module):
    """One softplus layer of a point x and its features h, of which it knows nothing at first:

    f = w·σ(D x + L h + b) + c,   mean over the rows d of D of max(d·x, 0) = ‖x‖/4.

    D: directions, evenly spread, with their opposites; w: 4/n; c: −radius.
    """

    def __init__(self, features: int, width: int, radius: float, generator: torch.Generator | None) -> None:
        super().__init__()
        half = fibonacci(width // 2).float()
        self.directions = nn.Parameter(torch.cat([half, -half]))
        self.links = nn.Parameter(
            torch.randn(len(self.directions), features, generator=generator) / features**0.5
        )
        self.bias = nn.Parameter(torch.zeros(len(self.directions)))
        self.head = nn.Parameter(torch.full((len(self.directions),), 4.0 / len(self.directions)))
        self.offset = nn.Parameter(torch.full((), -radius))

    def forward(self, points: Float[Tensor, "n 3"], features: Float[Tensor, "n k"]) -> Float[Tensor, " n"]:
        """f."""
        sums = points @ self.directions.t() + features @ self.links.t() + self.bias
        return nn.functional.softplus(sums, beta=SHARPNESS) @ self.head + self.offset


def rows(corners: Int64[Tensor, "*n 3"], cells: int, count: int) -> Int64[Tensor, "*n"]:
    """The row of every corner in a level's table: its own where there are enough, else eq. 4's."""
    i, j, k = corners.unbind(-1)
    if (cells + 1) ** 3 <= count:
        return (i * (cells + 1) + j) * (cells + 1) + k
    return (i * PRIMES[0] ^ j * PRIMES[1] ^ k * PRIMES[2]) % count

"""Draws that know normals, and from them the signs that free space does not tell."""

import numpy as np
import torch
from jaxtyping import Float, Float64, Int64
from scipy.spatial import KDTree
from torch import Tensor

from weingarten.scan.continuation import Continuation
from weingarten.scan.detail import detail
from weingarten.scan.draws import POOL, REACH, SignedDraws, positions
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.orientation import TRUSTED, Orientation, orientation
from weingarten.scan.pace import pace
from weingarten.scan.sample import Sample

Points = Float64[np.ndarray, "n 3"]

WITHIN, WIDTH = 0.3, 0.5
"""Share of the pool that lies in the shell where normals tell signs; how far about the cloud, in τ."""

HEAD_ON = 0.8
"""Least |cosine| between a normal that tells and the way to the point that is told."""

SURE = 10
"""Points of a rim at least from which anything goes on."""

BEYOND, CLOSE = 0.1, 0.12
"""Share of the pool that lies beyond rims, where the cloud has any; how far from the surface that goes on
there, unit lengths."""


class OrientedDraws(SignedDraws):
    """Signed draws that also know normals, outward and as long as they are to be trusted.

    Free space tells the normals' signs, and they tell signs where it is silent: WITHIN of the pool lie in the
    shell, about the cloud at N(0, (WIDTH τ)²), with the distance that the nearest point's normal gives.
    Where the cloud ends, surfaces go on as they end (`weingarten.scan.continuation`), and that is believed
    before free space that has leaked in.

    planes: as in `weingarten.scan.orientation.orientation`. rims: numbers of the points where the cloud ends.
    """

    def __init__(
        self,
        points: Float64[np.ndarray, "n 3"],
        tree: KDTree,
        space: FreeSpace,
        generator: torch.Generator,
        planes: tuple[Points, Float64[np.ndarray, " n"]] | None = None,
        rims: tuple[Int64[np.ndarray, " _"], ...] = (),
    ) -> None:
        super().__init__(points, tree, space, generator)
        told = self.nearest >= 0
        witnesses, signs = positions(self.pool)[told], np.sign(self.distance.numpy()[told])
        found = orientation(points, tree, witnesses, signs.astype(np.float64), self.nearest[told], planes)
        self.normals, self.detail = torch.from_numpy(found.normals.astype(np.float32)), detail(found)
        self.pace, self.known = pace(found.sheets), found.known
        self.apart = min(self.apart, found.sheets.apart)
        within, distance = self.within(tree, found, WIDTH * space.shell, generator)
        kept = torch.randperm(len(self.pool), generator=generator)[: POOL - len(within)]
        self.pool = torch.cat([self.pool[kept], within])
        self.distance = torch.cat([self.distance[kept], distance])
        onward = continuation(points, tree, found, rims)
        if onward is not None:
            self.go_on(onward, space, generator)

    def go_on(self, onward: Continuation, space: FreeSpace, generator: torch.Generator) -> None:
        """Add places from beyond rims to the pool, and tell of it what lies there.

        Free space may have leaked in: of what it says there, only an inside, which is closed, is believed.
        """
        lower, upper = (torch.from_numpy(corner.astype(np.float32)) for corner in onward.box(CLOSE))
        drawn = lower + (upper - lower) * torch.rand(POOL, 3, generator=generator)
        close = torch.from_numpy(np.abs(onward.told(positions(drawn))) < CLOSE)
        drawn = drawn[close][: int(BEYOND * POOL)]
        kept = torch.randperm(len(self.pool), generator=generator)[: POOL - len(drawn)]
        self.pool = torch.cat([self.pool[kept], drawn])
        known = torch.cat([self.distance[kept], torch.from_numpy(space.signed_distance(positions(drawn)))])
        told = torch.from_numpy(onward.told(positions(self.pool)).astype(np.float32))
        self.distance = torch.where(told.isnan() | (known < 0.0), known, told)

    def within(
        self, tree: KDTree, found: Orientation, width: float, generator: torch.Generator
    ) -> tuple[Float[Tensor, "m 3"], Float[Tensor, " m"]]:
        """Points in front of trusted points of the cloud or behind them, and their signed distances."""
        about = torch.randint(len(self.points), (int(2 * WITHIN * POOL),), generator=generator)
        drawn = self.points[about] + width * torch.randn(len(about), 3, generator=generator)
        at = positions(drawn)
        nearest = found.sheets.before(at, np.asarray(tree.query(at, workers=-1)[1]))
        gap = np.linalg.norm(at - tree.data[nearest], axis=1)
        trust = found.trust[nearest]
        along = np.einsum("nd,nd->n", at - tree.data[nearest], found.normals[nearest])
        frontal = (trust > TRUSTED) & (np.abs(along) > HEAD_ON * trust * gap)
        frontal &= np.abs(at).max(axis=1) < REACH
        chosen = np.flatnonzero(frontal)[: int(WITHIN * POOL)]
        distance = (along[chosen] / trust[chosen]).astype(np.float32)
        return drawn[torch.from_numpy(chosen)], torch.from_numpy(distance)

    def move(self, device: torch.device) -> None:
        """See CloudDraws."""
        super().move(device)
        self.normals = self.normals.to(device)

    def surface(self, chosen: Tensor) -> Sample:
        """See CloudDraws."""
        return Sample(self.points[chosen], normals=self.normals[chosen], weight=self.weights(chosen))


def continuation(
    points: Points, tree: KDTree, found: Orientation, rims: tuple[Int64[np.ndarray, " _"], ...]
) -> Continuation | None:
    """Of the rims where normals are to be trusted; None where there are none."""
    normals = found.normals / np.maximum(found.trust, TRUSTED)[:, None]
    return Continuation.of(points, tree, normals, tuple(rim for rim in rims if len(rim) >= SURE))

"""What a method may know of its points: where they are drawn, and what is told of them.

Each takes a cloud in the unit frame, the tree of its points and the generator, and gives the draws of every
step with notes for the user.
"""

from collections.abc import Callable

import numpy as np
import torch
from jaxtyping import Float64
from scipy.spatial import KDTree

from weingarten.scan.draws import REACH, CloudDraws, MeasuredDraws, SignedDraws
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.oriented_draws import OrientedDraws

Points = Float64[np.ndarray, "n 3"]
Knowledge = Callable[[Points, KDTree, torch.Generator], tuple[CloudDraws, tuple[str, ...]]]


def positions_alone(
    unit: Points, tree: KDTree, generator: torch.Generator
) -> tuple[CloudDraws, tuple[str, ...]]:
    """Nothing but the points: the published methods."""
    return CloudDraws(unit, tree), ()


def signs_of_free_space(
    unit: Points, tree: KDTree, generator: torch.Generator
) -> tuple[CloudDraws, tuple[str, ...]]:
    """Signed distances where empty space tells inside from outside."""
    space = FreeSpace.of(unit, tree, REACH)
    return SignedDraws(unit, tree, space, generator), space.notes


def signs_and_normals(
    unit: Points, tree: KDTree, generator: torch.Generator
) -> tuple[CloudDraws, tuple[str, ...]]:
    """Normals too, whose signs empty space tells, and signed distances near the points, by their normals."""
    space = FreeSpace.of(unit, tree, REACH)
    return OrientedDraws(unit, tree, space, generator), space.notes


def unsigned_distances(
    unit: Points, tree: KDTree, generator: torch.Generator
) -> tuple[CloudDraws, tuple[str, ...]]:
    """Distances to the nearest point of the cloud, without signs."""
    return MeasuredDraws(unit, tree, generator), ()

"""What a method may know of its points: where they are drawn, and what is told of them.

Each takes the points of a cloud, their tree and the generator, and gives the draws of every
step with notes for the user.
"""

from collections.abc import Callable

import torch
from scipy.spatial import KDTree

from weingarten.scan.draws import REACH, CloudDraws, MeasuredDraws, SignedDraws
from weingarten.scan.free_space import FreeSpace
from weingarten.scan.oriented_draws import OrientedDraws
from weingarten.scan.settled import Settled

Knowledge = Callable[[Settled, KDTree, torch.Generator], tuple[CloudDraws, tuple[str, ...]]]


def positions_alone(
    cloud: Settled, tree: KDTree, generator: torch.Generator
) -> tuple[CloudDraws, tuple[str, ...]]:
    """Nothing but the points: the published methods."""
    return CloudDraws(cloud.points, tree), ()


def signs_of_free_space(
    cloud: Settled, tree: KDTree, generator: torch.Generator
) -> tuple[CloudDraws, tuple[str, ...]]:
    """Signed distances where empty space tells inside from outside."""
    space = FreeSpace.of(cloud.points, tree, REACH)
    return SignedDraws(cloud.points, tree, space, generator), space.notes


def signs_and_normals(
    cloud: Settled, tree: KDTree, generator: torch.Generator
) -> tuple[CloudDraws, tuple[str, ...]]:
    """Normals too, whose signs empty space tells, and signed distances near the points, by their normals."""
    space = FreeSpace.of(cloud.points, tree, REACH)
    planes = None if cloud.flat is None or cloud.normals is None else (cloud.normals, cloud.flat)
    return OrientedDraws(cloud.points, tree, space, generator, planes, cloud.rims), space.notes


def unsigned_distances(
    cloud: Settled, tree: KDTree, generator: torch.Generator
) -> tuple[CloudDraws, tuple[str, ...]]:
    """Distances to the nearest point of the cloud, without signs."""
    return MeasuredDraws(cloud.points, tree, generator), ()

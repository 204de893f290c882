"""Points drawn from a surface, and what a scanner would do to them.

Every draw comes from one `numpy.random.Generator(PCG64(seed))`: the same seed gives the same points on
every machine.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64, Int64

from weingarten.errors import InputError, OptionError
from weingarten.mesh import Mesh

Points = Float64[np.ndarray, "n 3"]
Seed = int | Sequence[int]


def generator(seed: Seed) -> np.random.Generator:
    """The one kind of random generator: PCG64 from a non-negative integer, or several."""
    return np.random.Generator(np.random.PCG64(seed))


def sample_surface(mesh: Mesh, count: int, seed: Seed) -> tuple[Points, Int64[np.ndarray, " n"]]:
    """`count` points uniform by area on the mesh, in its frame, and the face that each lies on.

    A face is drawn with probability area / total; within it p = a + u (b − a) + v (c − a), (u, v) uniform
    in the unit square and reflected, (1 − u, 1 − v), where u + v > 1. Faces without area get no points.

    Raises InputError when the mesh has no area at all, or none that is finite.
    """
    cumulative = np.cumsum(mesh.areas)
    total = float(cumulative[-1]) if len(cumulative) else 0.0
    if not (np.isfinite(total) and total > 0):
        raise InputError("The mesh has no surface to sample: it has no faces, or none with a finite area.")
    draw = generator(seed)
    faces = np.searchsorted(cumulative, draw.random(count) * total, side="right").astype(np.int64)
    faces = np.minimum(faces, np.searchsorted(cumulative, total))
    u, v = draw.random((2, count))
    outside = u + v > 1
    u[outside], v[outside] = 1 - u[outside], 1 - v[outside]
    a, b, c = mesh.corners[faces].transpose(1, 0, 2)
    return a + u[:, None] * (b - a) + v[:, None] * (c - a), faces


def corrupt(points: Points, noise: float, outliers: float, seed: Seed) -> Points:
    """The points as a poor scanner would give them; a new array of the same length and order.

    noise: standard deviation, in world units, of a Gaussian added to every coordinate.
    outliers: fraction in [0, 1) of the points (rounded to whole points) that are replaced by uniform ones
        in the bounding box of the clean cloud, its sides lengthened by a tenth about its centre.

    Raises OptionError when noise is negative or outliers lies outside [0, 1).
    """
    if not (np.isfinite(noise) and noise >= 0):
        raise OptionError(f"The noise must be a finite length of 0 or more, in the mesh's unit; got {noise}.")
    if not 0 <= outliers < 1:
        raise OptionError(f"The fraction of outliers must be at least 0 and less than 1; got {outliers}.")
    draw = generator(seed)
    result = points + noise * draw.standard_normal(points.shape)
    replaced = draw.choice(len(points), size=round(outliers * len(points)), replace=False)
    lowest, highest = points.min(axis=0), points.max(axis=0)
    margin = 0.05 * (highest - lowest)
    result[replaced] = draw.uniform(lowest - margin, highest + margin, (len(replaced), 3))
    return result

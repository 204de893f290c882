"""How far the points of a cloud are from their surface, from the cloud alone."""

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

NEIGHBOURS = 24
ASKED = 1000
"""Points whose neighbourhoods are looked at, spread over the cloud's order."""

UNKNOWNS = 3
"""Of a plane."""


def noise_level(points: Float64[np.ndarray, "n 3"], tree: KDTree) -> float:
    """Mean distance of the points from the planes through their neighbourhoods, in the points' unit.

    The lower quartile over neighbourhoods of mean |residual| of a least-squares plane, times √(k / (k − 3))
    for what the fit takes away: edges and tight curvature, which are no noise, are in the other quartiles. Of
    Gaussian noise of standard deviation σ on a plane it is about σ √(2/π).
    """
    chosen = points[np.linspace(0, len(points) - 1, min(ASKED, len(points))).astype(int)]
    count = min(NEIGHBOURS, len(points))
    near = points[tree.query(chosen, k=count, workers=-1)[1].reshape(len(chosen), count)]
    offsets = near - near.mean(axis=1, keepdims=True)
    normal = np.linalg.svd(offsets, full_matrices=False)[2][:, -1]
    residual = np.abs(np.einsum("nki,ni->nk", offsets, normal)).mean(axis=1)
    return float(np.quantile(residual, 0.25) * np.sqrt(count / max(1, count - UNKNOWNS)))

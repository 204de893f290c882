"""Normals of neighbourhoods: directions of least variance (Hoppe et al. 1992, §3.2)."""

import numpy as np
from jaxtyping import Float64


def plane_normals(
    patches: Float64[np.ndarray, "n k 3"],
) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, " n"]]:
    """The unit normal of the plane of least squares through each patch, of arbitrary sign; and its flatness.

    The flatness is the ratio of the two smaller variances: 0 on a plane, 1 where there is no direction.
    """
    centred = patches - patches.mean(axis=1, keepdims=True)
    variances, directions = np.linalg.eigh(centred.transpose(0, 2, 1) @ centred)
    return directions[:, :, 0], variances[:, 0] / np.maximum(variances[:, 1], np.finfo(float).tiny)

"""Normals of neighbourhoods: directions of least variance (Hoppe et al. 1992, §3.2)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True)
class Planes:
    """The planes of least squares through patches.

    centres: the points' means. variances: along their principal axes, the least first. axes: these, unit
    columns of arbitrary sign.
    """

    centres: Float64[np.ndarray, "n 3"]
    variances: Float64[np.ndarray, "n 3"]
    axes: Float64[np.ndarray, "n 3 3"]

    @property
    def normals(self) -> Float64[np.ndarray, "n 3"]:
        """Unit, of arbitrary sign."""
        return self.axes[:, :, 0]


def least_planes(patches: Float64[np.ndarray, "n k 3"]) -> Planes:
    """Through each patch."""
    centres = patches.mean(axis=1)
    centred = patches - centres[:, None]
    variances, axes = np.linalg.eigh(centred.transpose(0, 2, 1) @ centred)
    return Planes(centres, variances / patches.shape[1], axes)


def plane_normals(
    patches: Float64[np.ndarray, "n k 3"],
) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, " n"]]:
    """The unit normal of the plane of least squares through each patch, of arbitrary sign; and its flatness.

    The flatness is the ratio of the two smaller variances: 0 on a plane, 1 where there is no direction.
    """
    planes = least_planes(patches)
    return planes.normals, planes.variances[:, 0] / np.maximum(planes.variances[:, 1], np.finfo(float).tiny)

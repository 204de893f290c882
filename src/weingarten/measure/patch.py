"""A few points of a surface, with what the field says of it there."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True, eq=False)
class Patch:
    """points: of the cloud. normals: outward, unit length. curvatures: κ₁ ≤ κ₂ of the field, 1/length."""

    points: Float64[np.ndarray, "n 3"]
    normals: Float64[np.ndarray, "n 3"]
    curvatures: Float64[np.ndarray, "n 2"]

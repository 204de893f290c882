"""A fit of a second, for tests of what surrounds it."""

import numpy as np

from weingarten.samples.parts import sample_part
from weingarten.settings import Settings, resolve


def small_settings(steps: int = 4, seed: int = 0) -> Settings:
    """Few steps of few points, and a coarse surface."""
    return resolve(steps=steps, points=50, resolution=8, seed=seed, sharp=False)


def small_cloud(seed: int = 0) -> np.ndarray:
    """Few points of a bundled part."""
    return sample_part("block", 600, seed)

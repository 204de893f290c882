"""The figures of arXiv 2511.03147, Tables 1 and 2: means over 25 ABC parts that the paper does not name."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PublishedRow:
    """One schedule's: mean and standard deviation between parts.

    normal_consistency and f1 in %, chamfer ×10³ unit-cube lengths, seconds on one L4 GPU. The parts' fits
    stop by the distance to the truth (the oracle).
    """

    normal_consistency: tuple[float, float]
    chamfer: tuple[float, float]
    f1: tuple[float, float]
    seconds: float


STEP = PublishedRow((97.99, 1.51), (2.87, 1.34), (92.71, 9.70), 1004.0)

PUBLISHED_ROWS = {
    "constant": PublishedRow((96.14, 4.73), (4.37, 5.48), (84.98, 24.18), 877.0),
    "linear": PublishedRow((97.95, 1.60), (3.05, 2.17), (90.59, 16.89), 883.0),
    "quintic": PublishedRow((98.01, 1.46), (2.86, 1.22), (92.72, 10.08), 878.0),
    "step": STEP,
    "step-next": STEP,
    "increasing": PublishedRow((97.68, 1.74), (3.24, 2.37), (88.32, 20.81), 871.0),
}
"""By schedule. The paper has one row for the step, whose formula and released code differ: both
stand beside it."""

"""How fast a fit may learn: half as fast where the surface is crowded, with thin walls, fins and narrow gaps.

A surface is crowded where most points have another sheet of it among their neighbours
(`weingarten.scan.sheets`). There the field has to change its sign so often that a greatest rate which is best
elsewhere keeps it from settling until the last fifth of the steps.
"""

from weingarten.scan.sheets import Sheets

CROWDED = 0.5
"""Share of the points."""

SLOW = 0.5


def pace(sheets: Sheets) -> float:
    """By what factor the learning rate is smaller: 1 or SLOW."""
    return SLOW if sheets.crowd > CROWDED else 1.0

"""What a cloud cannot tell, however well it is fitted: known before the first step."""

import numpy as np
from jaxtyping import Float64

from weingarten.scan.noise import Noise

Points = Float64[np.ndarray, "_ 3"]

KNOWN, KNOWN_IN_NOISE = 0.92, 0.5
"""Share of the points with a normal that is to be trusted, below which a person should look: a part with many
edges has 0.96 with enough points, and less where noise was told already."""


def doubts(noise: Noise, known: float, rims: tuple[Points, ...], scale: float) -> tuple[str, ...]:
    """What a person should know, a sentence each; none where nothing speaks against the cloud.

    known: share of the points whose normal is to be trusted. rims: where the cloud ends, world frame, the
    longest first. scale: of the unit frame, in the cloud's unit.
    """
    found: tuple[str, ...] = ()
    if noise.level > 0.0:
        found += (
            f"The points scatter by about {noise.level * scale:.2g} and were evened out: detail as small as "
            "that is lost, and edges are rounded off.",
        )
    if known < (KNOWN_IN_NOISE if noise.level > 0.0 else KNOWN):
        found += (
            f"At {100 * (1 - known):.0f} % of the points their neighbours do not tell how the surface lies: "
            "there are too few points for its detail and its thin walls, or too much noise. Holes and "
            "handles may be wrong there.",
        )
    if rims:
        place = ", ".join(f"{value:.4g}" for value in rims[0].mean(axis=0))
        found += (
            f"The cloud is open: {sum(map(len, rims)):,} points lie on rims, the longest around ({place}). "
            "What closes the surface beyond is a guess; --trim-distance leaves out what is far from points.",
        )
    return found

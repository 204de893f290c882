"""How finely a part is detailed: how much edge its surface has, told by where neighbourhoods are not flat.

A neighbourhood is not flat (`weingarten.scan.orientation`) where it reaches across an edge: on a strip as
wide as the neighbourhood on either side of it. With r the median radius of neighbourhoods and s the share of
the points about which it is not flat,

    e = s / 2r

is about the length of edges per area, whatever the density of the cloud. Where e is ten, two edges are about
a tenth apart, and waves of that length have to be in the field from the start: sines that a fit begins with
are moved little by it.
"""

import math

from weingarten.scan.orientation import Orientation

PLAIN = 2.5
"""Edge length per area, 1 / unit length, up to which waves as long as in Sitzmann et al. 2020 will do."""

FINEST = 1.6
"""Greatest factor: with more, waves are too short to lead from one known point to the next."""

LEAST_KNOWN = 0.5
"""Share of flat neighbourhoods below which noise, or too few points, and not edges have to be assumed."""


def detail(found: Orientation) -> float:
    """By what factor the first layer's weights begin larger: √(e / PLAIN), from 1 to FINEST; unit frame."""
    if found.bent > 1.0 - LEAST_KNOWN:
        return 1.0
    return min(FINEST, math.sqrt(max(1.0, found.bent / (2.0 * found.radius) / PLAIN)))

"""What a cloud cannot tell, however well it is fitted: known before the first step."""

from weingarten.scan.noise import Noise

KNOWN = 0.5
"""Share of the points with a normal that is to be trusted, below which a person should look."""


def doubts(noise: Noise, known: float, scale: float) -> tuple[str, ...]:
    """What a person should know, a sentence each; none where nothing speaks against the cloud.

    known: share of the points whose normal is to be trusted. scale: of the unit frame, in the cloud's unit.
    """
    found: tuple[str, ...] = ()
    if noise.level > 0.0:
        found += (
            f"The points scatter by about {noise.level * scale:.2g} and were evened out: detail as small as "
            "that is lost, and edges are rounded off.",
        )
    if known < KNOWN:
        found += (
            f"At {100 * (1 - known):.0f} % of the points their neighbours do not tell how the surface lies: "
            "there are too few points for its detail, or too much noise, and its shape there is a guess.",
        )
    return found

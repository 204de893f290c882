"""The strongest curvature weight that the data allow: Morozov's discrepancy principle as a controller.

V. A. Morozov, "On the solution of functional equations by the method of regularization", Soviet Math. Dokl.,
1966. Our own rule; arXiv 2511.03147 leaves data-driven weights as future work.
"""

import math
from collections.abc import Mapping
from typing import Any

from weingarten.errors import OptionError
from weingarten.schedules.seen import Seen, sound
from weingarten.terms.dirichlet import DIRICHLET

FINEST = 1e-4
"""Least noise level, unit lengths: finer than fits come. A cloud without noise asks for the least weight."""

HOLD = 0.1
"""Until then the weight stays. In its first tenth a fit was seen to stand still at a residual of 0.01, with λ
at 0 as at 10, while inside and outside are told apart: the residual says nothing of λ there."""

HORIZON = 0.1
"""How far ahead the residual is extrapolated, as a share of the fit."""

QUICK, SLOW = 0.015, 0.045
"""Memories of the two averages whose difference tells how fast the residual falls, likewise."""

SPEED, WIDTH = 10.0 * math.log(10.0), 2.0
"""At an excess of WIDTH (R = e²δ) or more the weight falls by a decade in a tenth of the fit, about as fast
as in the paper's schedules; at a smaller one in proportion. With these, a residual that goes as λ^p and
follows it within 0.06 of the fit settles without swinging for p up to 2.5, the steepest seen (λ from 3 to 10
at the end of a fit)."""

SMOOTHING = 0.01
"""Memory of the average over the weight: short, for it is smooth by itself, and delay makes it swing."""

LEAST = 1e-4
"""Of the ratio: the last knot but one of the paper's schedules is 0.001 of 10."""

WIDEST = math.log(1e3)
"""The logarithm of a residual over δ counts within ±this, so that one absurd loss does little."""


class Discrepancy:
    """Holds the reference weight while the data residual can get below the noise, else lowers it. A Ratio.

        e = log(R / δ),   R = mean |f| on the cloud (the data term's loss, unweighted)
        d log ρ / dt = −SPEED · clip((ē + min(HORIZON, 1 − t) · dē/dt) / WIDTH, −1, 1),   LEAST ≤ ρ ≤ 1

    δ is the mean distance of the points from the surface that they were measured on, unit lengths (for
    Gaussian noise of standard deviation σ along the normal, σ√(2/π)), and comes from the cloud alone. Of all
    fields that agree with the data as well as the noise lets them, Morozov takes the most regular one; so λ
    is to be as great as it can be with R ≤ δ. More would smooth away edges, less would fit the noise.

    The principle speaks of the finished fit. At its beginning R is far above δ because nothing is fitted yet
    and not because of λ, and lowering λ for that would give up the strong weight when it is wanted most, to
    get the topology right. Three things keep it:
    - it stays at the reference until HOLD;
    - what is controlled is not the residual of now but what it will be a HORIZON ahead, if it goes on
      falling as it does: λ is left alone while the fit gets there by itself, and lowered where it stalls.
      (In a controller's words, a derivative part; it also damps the loop.) Near the end nothing is left to
      hope for, and the residual itself counts;
    - it is not a ratchet: what was lowered too soon comes back as soon as R is on its way below δ, at the
      same speed, and at most to the reference.

    Acting on log λ makes the speed the same at any λ; clipping bounds it, so a large excess is answered by a
    steady decay over decades, much as the paper's schedules have it, and a small one by a small correction.
    On a cloud with next to no noise the weight thus decays as they do; on a noisy one it stays. Where the
    residual is zero or NaN the last one stays. LEAST keeps the term alive.
    """

    gradients_every = 0

    def __init__(self, noise: float, data: str = DIRICHLET.name) -> None:
        if not 0.0 <= noise < math.inf:
            raise OptionError(f"The noise level must be a length of at least 0 in unit lengths; got {noise}.")
        self.level, self.data = max(noise, FINEST), data
        self.progress: float | None = None
        self.residual: float | None = None
        self.quick: float | None = None
        self.slow: float | None = None
        self.exponent = 0.0

    def ratio(self) -> float:
        """ρ."""
        return math.exp(self.exponent)

    def watch(self, seen: Seen) -> None:
        """Take in one step."""
        passed = 0.0 if self.progress is None else max(0.0, seen.progress - self.progress)
        self.progress = seen.progress
        residual = seen.losses.get(self.data, math.nan)
        if residual > 0.0 and sound(residual):
            self.residual = residual
        if self.residual is not None:
            self.average(self.residual, passed)
        if seen.progress >= HOLD:
            drive = max(-1.0, min(self.excess(seen.progress) / WIDTH, 1.0))
            self.exponent = max(math.log(LEAST), min(self.exponent - SPEED * passed * drive, 0.0))

    def average(self, residual: float, passed: float) -> None:
        """Bring both averages of e up to date."""
        now = max(-WIDEST, min(math.log(residual / self.level), WIDEST))
        self.quick = averaged(self.quick, now, passed / QUICK)
        self.slow = averaged(self.slow, now, passed / SLOW)

    def excess(self, progress: float) -> float:
        """ē a horizon ahead; 0 where nothing is known.

        Of a steady slope the averages lag behind by QUICK and by SLOW, so their difference is that slope
        times SLOW − QUICK.
        """
        if self.quick is None or self.slow is None:
            return 0.0
        slope = (self.quick - self.slow) / (SLOW - QUICK)
        return self.quick + max(0.0, min(HORIZON, 1.0 - progress)) * slope

    def state(self) -> dict[str, Any]:
        """What it last saw, averages and exponent, as plain JSON values."""
        return {
            "progress": self.progress,
            "residual": self.residual,
            "quick": self.quick,
            "slow": self.slow,
            "exponent": self.exponent,
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """The inverse of `state`, to the bit."""
        self.progress, self.residual = state["progress"], state["residual"]
        self.quick, self.slow, self.exponent = state["quick"], state["slow"], state["exponent"]


def averaged(before: float | None, now: float, memories: float) -> float:
    """An exponential moving average after so many of its memories."""
    return now if before is None else before + (1.0 - math.exp(-memories)) * (now - before)

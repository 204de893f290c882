"""Deviations as colours: from blue through pale to red, or from pale to dark where they have no sign."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, UInt8

from weingarten.report.heat import ANCHORS, colour_map, exponent, power, rounded_up

Values = Float64[np.ndarray, " n"]

SIGNED = ("#123a7a", "#2f74c0", "#8dbce0", "#e9eee6", "#f4b27c", "#dc5a35", "#86141c")
"""From inside of the mesh to outside; told apart by all kinds of eyes."""
UNKNOWN = "#5d5768"
"""Of places that no point is near."""
LEAST, MOST = 1, 255
"""Levels of the ends of the scale; level 0 is of what is unknown."""
PERCENTILE = 99.0
NARROWEST = 1e-5
"""Half-width of a scale at least, in the cloud's diagonal."""


@dataclass(frozen=True)
class Colours:
    """A scale of deviations. end: where it ends, in the cloud's unit. signed: whether it begins at −end."""

    end: float
    signed: bool

    @classmethod
    def of(cls, value: Values, signed: bool, diagonal: float) -> "Colours":
        """The scale that takes in 99 % of the deviations; it ends at 1, 2 or 5 times a power of ten."""
        end = float(np.percentile(np.abs(value), PERCENTILE))
        return cls(rounded_up(max(end, NARROWEST * diagonal, np.finfo(np.float64).tiny)), signed)

    @property
    def start(self) -> float:
        """Where it begins."""
        return -self.end if self.signed else 0.0

    @property
    def anchors(self) -> tuple[str, ...]:
        """Evenly spaced from start to end."""
        return SIGNED if self.signed else ANCHORS

    def levels(self, value: Float64[np.ndarray, "*any"]) -> Float64[np.ndarray, "*any"]:
        """Places on `palette`, 0 for NaN."""
        place = np.clip((value - self.start) / (self.end - self.start), 0.0, 1.0)
        return np.where(np.isnan(place), 0.0, LEAST + (MOST - LEAST) * place)

    @property
    def palette(self) -> UInt8[np.ndarray, "256 3"]:
        """The colour of every level."""
        colours = colour_map(self.anchors)
        colours[0] = [int(UNKNOWN[i : i + 2], 16) for i in (1, 3, 5)]
        return colours

    def colours(self, value: Values) -> Float64[np.ndarray, "n 3"]:
        """Display colours, each channel 0 to 1."""
        return self.palette[np.round(self.levels(value)).astype(np.int64)] / 255.0

    @property
    def factor(self) -> float:
        """What a length is divided by to be shown in `unit`."""
        return 10.0 ** exponent(self.end)

    @property
    def unit(self) -> str:
        """The unit of the ticks, in words."""
        return f"{power(self.end)}the cloud’s unit"

    @property
    def said(self) -> str:
        """The scale for those who hear it."""
        return f"Colours of deviations from {self.start:g} to {self.end:g}, in the cloud’s unit"

    def ticks(self) -> list[tuple[float, str]]:
        """Where a tick stands, from 0 to 1, and what it says; beyond the ends colours stay the same."""
        places = [k / 4 for k in range(5)]
        values = [(self.start + place * (self.end - self.start)) / self.factor for place in places]
        texts = [worded(value, self.signed) for value in values]
        texts[-1] = f"≥ {texts[-1]}"
        texts[0] = f"≤ {texts[0]}" if self.signed else texts[0]
        return list(zip(places, texts, strict=True))


def worded(value: float, signed: bool) -> str:
    """A number of three digits with its sign, where it has one."""
    text = digits(value, 3)
    return f"+{text}" if signed and value > 0 else text.replace("-", "−")


def digits(value: float, count: int) -> str:
    """So many digits, without an exponent where it can be read so."""
    if value == 0.0 or not 1e-5 <= abs(value) < 1e9:
        return f"{value:.{count}g}"
    places = max(0, count - 1 - int(np.floor(np.log10(abs(value)))))
    text = f"{float(f'{value:.{count}g}'):,.{places}f}"
    return text.rstrip("0").rstrip(".") if places else text

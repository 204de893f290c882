"""Named figures of one comparison, as values and ready for print, and what was found on the way."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

import numpy as np
from jaxtyping import Float64

from weingarten.metrics.findings import Finding

Values = Float64[np.ndarray, " n"]
Plain = float | int | bool | None

LENGTH = {"unit": "×10⁻³ unit-cube lengths", "factor": 1e3, "digits": ".4f"}
SHARE = {"unit": "%", "factor": 1e2, "digits": ".2f"}
RATIO = {"digits": ".4f"}
WORLD_LENGTH = {"unit": "in the unit of the input", "digits": ".6g"}


@dataclass(frozen=True)
class Figure:
    """One figure ready for print: value = raw value × factor (a count or a truth value stays as it is).

    ceiling: what cannot be expected to be bettered, in the same unit; None where the protocol has none.
    """

    name: str
    label: str
    value: Plain
    unit: str = ""
    digits: str = ""
    ceiling: Plain = None

    @property
    def text(self) -> str:
        """The value with the digits that it deserves; "none" where there is no such figure."""
        if isinstance(self.value, bool):
            return "yes" if self.value else "no"
        return "none" if self.value is None else format(self.value, self.digits)

    @property
    def beside_ceiling(self) -> tuple[str, ...]:
        """The ceiling and the excess of the value over it, a word before each; nothing without a ceiling."""
        if self.value is None or self.ceiling is None:
            return ()
        excess = format(self.value - self.ceiling, f"+{self.digits}")
        return "ceiling", format(self.ceiling, self.digits), "excess", excess


@dataclass(frozen=True)
class Figures:
    """Named figures, raw: lengths in unit-cube lengths, shares in [0, 1].

    protocol: which they were taken under. findings: what the reader of the figures has to know.
    """

    protocol: str
    findings: tuple[Finding, ...] = field(default=(), kw_only=True)

    @property
    def flags(self) -> tuple[str, ...]:
        """The names of the findings."""
        return tuple(finding.name for finding in self.findings)

    def values(self) -> dict[str, Plain]:
        """Raw figures by name; None where a figure does not exist."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self) if "label" in entry.metadata}

    def as_dict(self) -> dict[str, object]:
        """Plain values for JSON: `protocol`, the figures, `flags`. None of them is NaN or infinite."""
        return {"protocol": self.protocol, **self.values(), "flags": list(self.flags)}

    def rows(self) -> list[Figure]:
        """The figures in order, scaled to the units in which the literature prints them."""
        rows = []
        for entry in fields(self):
            if "label" in entry.metadata:
                raw, shown = getattr(self, entry.name), dict(entry.metadata)
                factor = shown.pop("factor", None)
                value = raw if factor is None or raw is None else raw * factor
                rows.append(Figure(entry.name, value=value, **shown))
        return rows


def figure(label: str, shown: Mapping[str, str | float] | None = None):
    """A field of a Figures: its label, and how it is shown (LENGTH, SHARE, ...)."""
    return field(metadata={"label": label, **(shown or {})})


def f1(to_truth: Values, to_mesh: Values, threshold: float) -> float:
    """Harmonic mean of precision P(to_truth < τ) and recall P(to_mesh < τ); 0 when both are 0."""
    precision, recall = float((to_truth < threshold).mean()), float((to_mesh < threshold).mean())
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0


def mean_of_means(first: Values, second: Values) -> float:
    """½ (mean of the first + mean of the second)."""
    return 0.5 * (float(first.mean()) + float(second.mean()))

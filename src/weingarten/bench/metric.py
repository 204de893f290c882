"""The figures that a benchmark tabulates: their names, the units they are shown in, and which end is good."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Metric:
    """One figure. key: "PROTOCOL.name", as in results.csv; shown = raw value × factor.

    higher: whether more is better. aim: the value of a perfect mesh where that is neither end, else None.
    """

    key: str
    label: str
    unit: str
    factor: float
    digits: int
    higher: bool
    aim: float | None = None

    @property
    def protocol(self) -> str:
        """The protocol's name and version."""
        return self.key.split(".", 1)[0]

    @property
    def heading(self) -> str:
        """Label and unit."""
        return f"{self.label}, {self.unit}" if self.unit else self.label

    def loss(self, value: float) -> float:
        """Smaller is better, whatever the metric."""
        if self.aim is not None:
            return abs(value - self.aim)
        return -value if self.higher else value

    def shown(self, value: float | None) -> str:
        """A raw value as text; "none" where there is none."""
        return "none" if value is None else f"{value * self.factor:.{self.digits}f}"


def _length(key: str, label: str) -> Metric:
    return Metric(key, label, "×10⁻³", 1e3, 3, higher=False)


def _share(key: str, label: str) -> Metric:
    return Metric(key, label, "%", 1e2, 2, higher=True)


PUBLISHED_METRICS = (
    _share("published-1.normal_consistency", "NC"),
    _length("published-1.chamfer", "CD"),
    _share("published-1.f1", "F1"),
)
"""In the order of the paper's tables."""

EXCESS = _length("published-1.excess_chamfer", "CD over its ceiling")

EXACT_METRICS = (
    _length("exact-1.chamfer", "CD"),
    _length("exact-1.distance_95", "95th percentile"),
    _length("exact-1.hausdorff", "Hausdorff"),
    _share("exact-1.f1_005", "F1 at 0.005"),
    _share("exact-1.f1_001", "F1 at 0.001"),
    _share("exact-1.normal_consistency", "NC"),
    _length("exact-1.edge_chamfer", "edge CD"),
    _share("exact-1.edge_f1", "edge F1"),
    Metric("exact-1.volume_ratio", "volume ratio", "", 1.0, 4, higher=False, aim=1.0),
    _share("exact-1.watertight", "watertight"),
    _share("exact-1.topology_right", "topology right"),
)

METRICS = (*PUBLISHED_METRICS, EXCESS, *EXACT_METRICS)

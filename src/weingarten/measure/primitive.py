"""A primitive as it was found: its surface, how much of it there is, and how well it fits."""

from dataclasses import dataclass
from typing import Any

from weingarten.measure.surface import Surface


@dataclass(frozen=True, eq=False)
class Primitive:
    """Lengths in the cloud's unit, angles in degrees.

    surface: without ends, world frame. side: "boss" where the part is inside of it, "hole" where outside,
    None of planes. extent: how much of it there is, by name (`Surface.extent`). points: of the cloud on it;
    rms, p95: of their distances. area: of the mesh; share: of the mesh's whole area.
    same_plane, coaxial: numbers of the primitives in one plane, or about one axis, with this one.
    """

    surface: Surface
    side: str | None
    extent: dict[str, Any]
    points: int
    rms: float
    p95: float
    area: float
    share: float
    same_plane: tuple[int, ...] = ()
    coaxial: tuple[int, ...] = ()

    @property
    def kind(self) -> str:
        """plane, cylinder, cone, sphere or torus."""
        return self.surface.KIND

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        fit = {"points": self.points, "residual_rms": self.rms, "residual_p95": self.p95}
        whole = {"area": self.area, "share": self.share}
        related = {"same_plane": list(self.same_plane), "coaxial": list(self.coaxial)}
        return {
            "kind": self.kind,
            "side": self.side,
            **self.surface.geometry(),
            **self.extent,
            **fit,
            **whole,
            **related,
        }

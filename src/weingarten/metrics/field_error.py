"""How far a field is from the truth's signed distance, protocol `field-1`: is it a distance? See `Field`."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest, cut, inside
from weingarten.metrics.figures import LENGTH, SHARE, WORLD_LENGTH, Figures, Values, figure
from weingarten.metrics.findings import Finding, check_surface, has_inside, surface_findings
from weingarten.metrics.topology import topology
from weingarten.metrics.unit_cube import cube_frame, unit_cube, used_box
from weingarten.scan.sampling import generator, sample_surface

Points = Float64[np.ndarray, "n 3"]

BAND_STREAM, OFFSET_STREAM, BOX_STREAM = range(4, 7)
"""Not those of the protocols that compare meshes, for these points are others."""

GRADIENT = {"digits": ".4f"}

SHORT = 0.2
"""The truth is cut into triangles with edges of at most so many unit-cube lengths, to be asked faster."""


@runtime_checkable
class Sampled(Protocol):
    """A field at n world points, as `weingarten.world_field.FieldSample`."""

    @property
    def distance(self) -> Values:
        """Signed, negative inside, world units."""
        ...

    @property
    def gradient(self) -> Points:
        """No unit."""
        ...


WorldFunction = Callable[[Points], Sampled]


@dataclass(frozen=True)
class FieldFigures(Figures):
    """Errors of a field in the band and in the box of `Field`.

    Those of distance and sign are None where the truth has no inside (`findings.has_inside`); all of a domain
    are None where the field is not finite at some of its points. unit_length: as in `ExactFigures`.
    """

    distance_error_band: float | None = figure("distance error, band", LENGTH)
    distance_error_box: float | None = figure("distance error, box", LENGTH)
    gradient_error_band: float | None = figure("|‖∇f‖ − 1|, band", GRADIENT)
    gradient_error_box: float | None = figure("|‖∇f‖ − 1|, box", GRADIENT)
    wrong_sign_band: float | None = figure("wrong sign, band", SHARE)
    wrong_sign_box: float | None = figure("wrong sign, box", SHARE)
    unit_length: float = figure("unit-cube length", WORLD_LENGTH)


@dataclass(frozen=True)
class Errors:
    """Of a field in one domain; None where there is no such figure. bad: points where it is not finite."""

    distance: float | None = None
    gradient: float | None = None
    wrong_sign: float | None = None
    bad: int = 0


@dataclass(frozen=True)
class Field:
    """The error of a field f against the signed distance d of the truth, negative inside.

    Lengths are divided by the longest side of the truth's box, as in `exact-1`. In each of two domains: mean
    |f − d|; mean |‖∇f‖ − 1|, zero of any distance; and the share of points where f < 0 and d < 0 disagree.
    The band: 20,000 area-weighted samples of the truth's surface, each moved by a vector uniform in the ball
    of radius 0.05, so that the density at a point is proportional to the surface's area within 0.05 of it.
    The box: 20,000 points uniform in the truth's box, its sides lengthened by a tenth about its centre.

    |d| is the distance to the truth's triangles; inside is where its winding number is nearer to ±1 than
    to 0, so that a truth that is inside out is as good as any other.
    """

    name: str = "field-1"
    samples: int = 20_000
    band: float = 0.05
    margin: float = 0.1

    def evaluate(self, field: WorldFunction, truth: Mesh, seed: int = 0) -> FieldFigures:
        """Compare a field, callable on (n, 3) points of the truth's frame, with the truth.

        Raises InputError when the truth has no surface. What limits the figures is among their findings.
        """
        check_surface(truth, "truth")
        frame, true = cube_frame(truth), unit_cube(truth, truth)
        shape = topology(true)
        solid = has_inside(true, shape)
        surface = cut(true, SHORT) if solid else None
        band = self._errors(field, surface, frame, self.points_in_band(true, seed))
        box = self._errors(field, surface, frame, self.points_in_box(true, seed))
        return FieldFigures(
            protocol=self.name,
            findings=(*surface_findings(true, shape, "truth"), *_not_finite(band.bad + box.bad)),
            distance_error_band=band.distance,
            distance_error_box=box.distance,
            gradient_error_band=band.gradient,
            gradient_error_box=box.gradient,
            wrong_sign_band=band.wrong_sign,
            wrong_sign_box=box.wrong_sign,
            unit_length=frame.scale,
        )

    def points_in_band(self, true: Mesh, seed: int) -> Points:
        """The points of the band about a mesh, in its frame, whose unit is the band's."""
        surface, _ = sample_surface(true, self.samples, (seed, BAND_STREAM))
        draw = generator((seed, OFFSET_STREAM))
        direction = draw.standard_normal(surface.shape)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        return surface + self.band * np.cbrt(draw.random(self.samples))[:, None] * direction

    def points_in_box(self, true: Mesh, seed: int) -> Points:
        """The points of the box about a mesh, in its frame."""
        lowest, highest = used_box(true)
        margin = self.margin / 2 * (highest - lowest)
        return generator((seed, BOX_STREAM)).uniform(lowest - margin, highest + margin, (self.samples, 3))

    def _errors(self, field: WorldFunction, surface: Mesh | None, frame: Frame, points: Points) -> Errors:
        """At points of the unit cube; surface: that of the truth, None where it has no inside."""
        sample = field(frame.to_world(points))
        value = np.asarray(sample.distance, dtype=np.float64) / frame.scale
        slope = np.linalg.norm(np.asarray(sample.gradient, dtype=np.float64), axis=1)
        bad = int((~(np.isfinite(value) & np.isfinite(slope))).sum())
        if bad:
            return Errors(bad=bad)
        gradient = float(np.abs(slope - 1).mean())
        if surface is None:
            return Errors(gradient=gradient)
        within = inside(surface, points)
        distance = np.where(within, -1.0, 1.0) * closest(surface, points).distance
        return Errors(float(np.abs(value - distance).mean()), gradient, float(((value < 0) != within).mean()))


def _not_finite(bad: int) -> tuple[Finding, ...]:
    if not bad:
        return ()
    return (
        Finding("field-not-finite", f"The field is not finite at {bad:,} of the points it was asked at."),
    )


FIELD = Field()

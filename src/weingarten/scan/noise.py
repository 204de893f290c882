"""How far the points of a cloud are from their surface, from the cloud alone."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree
from scipy.special import gammaincinv

from weingarten.scan.normals import least_planes

Points = Float64[np.ndarray, "n 3"]

NEIGHBOURS = 24
ASKED = 1000
"""Points whose neighbourhoods are looked at, spread over the cloud's order."""

UNKNOWNS, BENT_UNKNOWNS = 3, 6
"""Of a plane; of z = c₀ + c₁ x + c₂ y + c₃ x² + c₄ x y + c₅ y²."""

FEWEST, MOST = 12, 192
"""Neighbours that noise is measured with: fewer do not tell it, more reach beyond what is flat."""

REACH = 5.0
"""Radius of a neighbourhood, in standard deviations of the noise, at which it is told from the surface."""

LOW, FLATTEST = 0.1, 0.3
"""The quantile of neighbourhoods that noise is read from; the share of them whose residuals are judged."""

ALIKE, KURTOSIS = 0.8, (2.2, 3.2)
"""Noise is the same everywhere: least ratio of the quantile to the median, both as standard deviations. And
residuals are Gaussian, of kurtosis 3, or less where a neighbourhood is small. Two sides of a thin wall have
one of 1, edges and curved places one far above 3."""

STRAIGHT = 0.75
"""Least share of the noise that is left where the surface may bend: the rest was curvature."""

GROWTH = 1.35
"""By how much the measured noise may grow with a doubled neighbourhood, which had been too small before."""


@dataclass(frozen=True)
class Noise:
    """level: standard deviation of the points from their surface, in their unit; 0 where no noise is certain.

    neighbours: of the neighbourhoods in which it is told from the surface.
    """

    level: float = 0.0
    neighbours: int = FEWEST


@dataclass(frozen=True)
class Residuals:
    """Of neighbourhoods of one size. level: as standard deviation of the noise, if they are noise at all.
    straight: the share of it that bent surfaces through the neighbourhoods leave.
    """

    level: float
    straight: float
    radius: float
    alike: float
    kurtosis: float

    @classmethod
    def of(cls, points: Points, tree: KDTree, neighbours: int) -> "Residuals":
        """About ASKED points."""
        asked = points[np.linspace(0, len(points) - 1, min(ASKED, len(points))).astype(int)]
        reach, near = tree.query(asked, k=neighbours + 1, workers=-1)
        patches = points[near]
        planes = least_planes(patches)
        places = np.einsum("nkd,ndc->nkc", patches - planes.centres[:, None], planes.axes)
        spread, level = lowest((places[:, :, 0] ** 2).sum(axis=1), neighbours + 1 - UNKNOWNS)
        flattest = spread <= np.quantile(spread, FLATTEST)
        offsets = places[flattest, :, 0]
        radius = float(np.median(np.asarray(reach)[:, -1]))
        offsets /= np.maximum(spread[flattest], np.finfo(float).eps * radius)[:, None]
        bent = lowest(beside_quadrics(places / radius), neighbours + 1 - BENT_UNKNOWNS)[1] * radius
        return cls(
            level=float(level),
            straight=float(bent / max(level, np.finfo(float).tiny)),
            radius=radius,
            alike=float(level / max(np.median(spread), np.finfo(float).tiny)),
            kurtosis=float((offsets**4).mean() / max((offsets**2).mean() ** 2, np.finfo(float).tiny)),
        )

    @property
    def noisy(self) -> bool:
        """Whether they look like noise, rather than like a surface."""
        gaussian = KURTOSIS[0] < self.kurtosis < KURTOSIS[1]
        return gaussian and self.alike > ALIKE and self.straight > STRAIGHT


def lowest(squares: Float64[np.ndarray, " n"], freedom: int) -> tuple[Float64[np.ndarray, " n"], float]:
    """√(Σ r² / freedom) of neighbourhoods, and the deviation of noise that gives their LOW quantile.

    That of χ² is 2 P⁻¹(freedom / 2, LOW), P the regularised incomplete gamma function: scipy.stats would take
    a fifth of a command's start to import.
    """
    spread = np.sqrt(squares / freedom)
    least = 2.0 * gammaincinv(0.5 * freedom, LOW)
    return spread, float(np.quantile(spread, LOW) / np.sqrt(least / freedom))


def beside_quadrics(places: Float64[np.ndarray, "n k 3"]) -> Float64[np.ndarray, " n"]:
    """Σ r² of least squares of each neighbourhood's z = c₀ + c₁ x + … + c₅ y²; places: z, x and y."""
    z, x, y = np.moveaxis(places, -1, 0)
    basis = np.linalg.qr(np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1))[0]
    along = np.einsum("nkc,nk->nc", basis, z)
    return np.maximum((z**2).sum(axis=1) - (along**2).sum(axis=1), 0.0)


def noise_of(points: Points, tree: KDTree) -> Noise:
    """The noise of a cloud in any frame, in neighbourhoods that are doubled until they tell it.

    Where residuals of even the smallest do not look like noise, or those of larger ones like two sides of a
    wall, there is none to speak of.
    """
    neighbours = FEWEST
    if len(points) <= MOST:
        return Noise()
    found = Residuals.of(points, tree, neighbours)
    if not found.noisy:
        return Noise()
    while found.radius < REACH * found.level and 2 * neighbours <= MOST:
        larger = Residuals.of(points, tree, 2 * neighbours)
        if larger.kurtosis < KURTOSIS[0]:
            return Noise()
        if not larger.noisy or larger.level > GROWTH * found.level:
            break
        found, neighbours = larger, 2 * neighbours
    return Noise(found.level, neighbours)


def noise_level(points: Points, tree: KDTree) -> float:
    """Mean distance of the points from the planes through their neighbourhoods, in the points' unit.

    The lower quartile over neighbourhoods of mean |residual| of a least-squares plane, times √(k / (k − 3))
    for what the fit takes away: edges and tight curvature, which are no noise, are in the other quartiles. Of
    Gaussian noise of standard deviation σ on a plane it is about σ √(2/π).
    """
    chosen = points[np.linspace(0, len(points) - 1, min(ASKED, len(points))).astype(int)]
    count = min(NEIGHBOURS, len(points))
    near = points[tree.query(chosen, k=count, workers=-1)[1].reshape(len(chosen), count)]
    offsets = near - near.mean(axis=1, keepdims=True)
    normal = np.linalg.svd(offsets, full_matrices=False)[2][:, -1]
    residual = np.abs(np.einsum("nki,ni->nk", offsets, normal)).mean(axis=1)
    return float(np.quantile(residual, 0.25) * np.sqrt(count / max(1, count - UNKNOWNS)))

"""Normals of a cloud: directions from neighbourhoods, signs from free space, spread along the surface.

A point's normal is the direction of least variance of its neighbourhood, or where that is not flat, that of
the plane which most of the neighbourhood shares with it (`weingarten.scan.facets`). Its sign is told by
witnesses: points of known signed distance whose nearest point of the cloud it is, so that nothing of the
surface lies between them. From there signs spread to where no witness is, into thin walls and narrow gaps, as
the minimiser of

    E(x) = ½ Σᵢⱼ wᵢⱼ (xᵢ − sᵢⱼ xⱼ)² + WITNESS Σᵢ |mᵢ| (xᵢ − sgn mᵢ)² + DOUBT Σᵢ xᵢ²

over pairs of neighbours, with sᵢⱼ = sgn nᵢ·nⱼ, wᵢⱼ = (nᵢ·nⱼ)² exp(−(cᵢⱼ / LEVEL)² − (oᵢⱼ / OFF)²), cᵢⱼ
the greater |cosine| between the way from i to j and the two normals, and oᵢⱼ the greater distance of one from
the other's tangent plane, in radii of the neighbourhood: across a wall the way leaves the tangent plane.
Neighbours on two sheets (`weingarten.scan.sheets`) have opposite normals: for them sᵢⱼ = −sgn nᵢ·nⱼ and
wᵢⱼ = OPPOSITE. So a sheet that no witness sees, as the inside of a narrow tray, is told by its other side.
mᵢ ∈ [−1, 1] is the mean cosine between a point's normal and the ways to its witnesses, with their signs.
xᵢ ∈ [−1, 1] has the sign of the normal, and |xᵢ| says how sure it is: where witnesses contradict each other
they cancel, and where there are none DOUBT has it. Like the harmonic extension of labels over a graph (Zhu,
Ghahramani & Lafferty 2003) with signs on the edges; Hoppe et al. 1992 spread them along a spanning tree,
where one wrong edge turns all that follows.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import cg
from scipy.spatial import KDTree

from weingarten.scan.facets import facets
from weingarten.scan.normals import plane_normals
from weingarten.scan.sheets import Sheets

Points = Float64[np.ndarray, "n 3"]

NEIGHBOURS = 12
"""Of a neighbourhood: fewer are drawn by noise, more reach through thin walls."""

LEVEL = 0.3
"""Sine of the angle, roughly, by which the way to a neighbour may leave the tangent plane."""

OTHERS = 16
"""Of the planes in which a point may lie beside edges."""

OFF = 0.15
"""Distance, roughly, by which a neighbour may be off the tangent plane, in radii of the neighbourhood."""

FRONTAL = 0.7
"""Least |cosine| between a point's normal and the way to a witness of its."""

WITNESS, DOUBT, BOND, OPPOSITE = 0.3, 1e-4, 1e-6, 0.1
"""Weights: of witnesses and of doubt against those of neighbours, of which none is below BOND; and of
neighbours on another sheet."""

FLAT = 0.03
"""Ratio of a neighbourhood's two smaller variances at which its normal counts half: edges and noise."""

ACCURACY, MOST_ROUNDS = 1e-4, 500
"""Of the conjugate gradients."""

TRUSTED = 0.3
"""Least trust in a normal that anything is concluded from."""


@dataclass(frozen=True)
class Orientation:
    """normals: outward, as long as they are to be trusted, from 0 to 1.
    radius: of the points' neighbourhoods, the median, in the unit of the points.
    bent: share of the points whose neighbourhood is not flat, or whose sign is not known.
    sheets: which of their neighbours are on the other side of a thin wall.
    """

    normals: Points
    radius: float
    bent: float
    sheets: Sheets

    @property
    def trust(self) -> Float64[np.ndarray, " n"]:
        """How long the normals are."""
        return np.linalg.norm(self.normals, axis=1)

    @property
    def known(self) -> float:
        """Share of the points whose normal is to be trusted."""
        return float(np.mean(self.trust > TRUSTED))


def orientation(
    points: Points,
    tree: KDTree,
    witnesses: Float64[np.ndarray, "m 3"],
    signs: Float64[np.ndarray, " m"],
    nearest: Int64[np.ndarray, " m"],
    planes: tuple[Points, Float64[np.ndarray, " n"]] | None = None,
) -> Orientation:
    """Normals of points in any frame.

    tree: of the points. witnesses: with their signs, +1 outside and −1 inside, and nearest points.
    planes: unit normals, and how flat it is about each point, from 0 to 1, where noise asked for larger
        neighbourhoods than these.
    """
    reach, near = tree.query(points, k=OTHERS + 1, workers=-1)
    radius, near = float(np.median(np.asarray(reach)[:, NEIGHBOURS])), np.asarray(near)[:, 1:]
    close = near[:, :NEIGHBOURS]
    if planes is None:
        normals, flat = flat_normals(points[close])
        shared = facets(points, near)
        clear = np.maximum(flat, shared.trust)
        normals = np.where((shared.trust > flat)[:, None], shared.normals, normals)
        sheets = Sheets.of(points, normals, close)
    else:
        normals, flat = planes
        clear, sheets = flat, Sheets.one(points, normals, close)
    told = evidence(points, normals, witnesses, signs, sheets.before(witnesses, nearest))
    signed = spread_signs(sheets, told)
    sure = np.minimum(np.abs(signed), 1.0)
    bent = float(np.mean(sure * flat <= TRUSTED))
    return Orientation(normals * (np.sign(signed) * sure * clear)[:, None], radius, bent, sheets)


def flat_normals(patches: Float64[np.ndarray, "n k 3"]) -> tuple[Points, Float64[np.ndarray, " n"]]:
    """Normals of patches, and how flat they are, from 0 to 1."""
    normals, flatness = plane_normals(patches)
    return normals, 1.0 / (1.0 + (flatness / FLAT) ** 2)


def evidence(
    points: Points,
    normals: Points,
    witnesses: Float64[np.ndarray, "m 3"],
    signs: Float64[np.ndarray, " m"],
    nearest: Int64[np.ndarray, " m"],
) -> Float64[np.ndarray, " n"]:
    """m: positive where a normal points outward, 0 where no witness stands before the point or behind it."""
    way = witnesses - points[nearest]
    cosine = np.einsum("md,md->m", way, normals[nearest]) / np.linalg.norm(way, axis=1)
    frontal = np.abs(cosine) > FRONTAL
    heard, said = nearest[frontal], (signs * cosine)[frontal]
    count = np.bincount(heard, minlength=len(points))
    return np.bincount(heard, said, minlength=len(points)) / np.maximum(count, 1)


def spread_signs(sheets: Sheets, told: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
    """x, the minimiser of E."""
    points, normals, near = sheets.points, sheets.normals, sheets.near
    count, k = near.shape
    way = points[near] - points[:, None]
    length = np.maximum(np.linalg.norm(way, axis=-1), np.finfo(float).tiny)
    off = np.maximum(
        np.abs(np.einsum("nkd,nd->nk", way, normals)), np.abs(np.einsum("nkd,nkd->nk", way, normals[near]))
    )
    cosine = np.einsum("nd,nkd->nk", normals, normals[near])
    weight = cosine**2 * np.exp(-((off / length / LEVEL) ** 2) - (off / length[:, -1:] / OFF) ** 2) + BOND
    weight = np.where(sheets.across, -OPPOSITE, weight)
    rows = np.arange(0, count * k + 1, k)
    graph = csr_matrix(((weight * np.sign(cosine)).ravel(), near.ravel(), rows), shape=(count, count))
    graph = 0.5 * (graph + graph.T)
    diagonal = np.asarray(abs(graph).sum(axis=1)).ravel() + WITNESS * np.abs(told) + DOUBT
    found, _ = cg(
        diags(diagonal) - graph,
        WITNESS * told,
        rtol=ACCURACY,
        maxiter=MOST_ROUNDS,
        M=diags(1.0 / diagonal),
    )
    return found

"""Tunnels and bridges that are narrower than the points are apart, and how to make the surface without them.

A field swings about zero where it knows nothing: between the feet of two fins, in a wall thinner than the
points are apart. Each tunnel of its zero set is closed by a level just above zero, at a critical point with
f > 0 and two negative curvatures; each bridge falls apart at a level just below, at one with f < 0 and one
negative curvature: the two ends of the handle's interval of persistence (Edelsbrunner, Letscher & Zomorodian
2002, "Topological persistence and simplification"). There |f| is half the handle's width. The surface is made
again of a field that is raised or lowered about such points, by a little more than |f|.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import igl
import numpy as np
import torch
from jaxtyping import Bool, Float, Float64
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist
from torch import Tensor

from weingarten.calculus.jet import HESSIAN, Jet, directions
from weingarten.mesh import Mesh
from weingarten.metrics.topology import topology
from weingarten.surface.lattice import Lattice
from weingarten.surface.octree import Values

Points = Float64[np.ndarray, "n 3"]
Chosen = Bool[np.ndarray, " n"]
Jets = Callable[[Points, int], Jet]
"""Positions, unit frame, and an order to the field's jets there, tangent frames not turned."""

SPACING, APART, MOST = 0.5, 0.25, 0.005
"""Half a handle's width at most: in distances from a point to its nearest; in distances of two sheets that
the points tell apart; in unit lengths."""

MOST_STARTS, SAME = 4000, 0.25
"""Narrow places at most, where there are more the field has no surface to speak of; reaches within which two
critical points are one."""

TURNED, SHARES = 0.6, np.array([0.25, 0.5, 0.75])
"""Another side is near where |f| twice the reach away from a vertex is less than TURNED times the greatest at
one of these shares of the way."""

STEPS, STRIDE, STIFFEST, FLAT, FAR = 15, 0.75, 5.0, 0.02, 10.0
"""Newton steps; how long one may be, in reaches; least curvature that is divided by, one over unit length;
greatest slope at a critical point; reaches from where the search began to it."""

WIDTH, DEPTH = 1.5, 0.3
"""Of the change about a critical point: its radius, and how much greater than |f| it is, in cells."""

AROUND = 2
"""Nodes on either side of the nearest one: those nearer than WIDTH change, which is that one and its
neighbours, and the Euler characteristic sees the cubes about them."""


@dataclass(frozen=True)
class Saddles:
    """Critical points of a field that close tunnels, f > 0, or cut bridges, f < 0."""

    places: Points
    values: Float64[np.ndarray, " n"]

    def of(self, chosen: Chosen) -> "Saddles":
        """Some of them."""
        return Saddles(self.places[chosen], self.values[chosen])


class Mended:
    """A field that is 0 beyond |f| at its saddles: f − (f(s) ± DEPTH h) (1 − d²/r²)², d from the nearest."""

    def __init__(self, values: Values, saddles: Saddles, cell: float) -> None:
        self.values, self.tree, self.radius = values, KDTree(saddles.places), WIDTH * cell
        self.change = saddles.values + np.sign(saddles.values) * DEPTH * cell

    def __call__(self, points: Float[Tensor, "n 3"]) -> Float[Tensor, " n"]:
        """The values, on the device of the field's."""
        found = self.values(points)
        return found - torch.from_numpy(self.bumps(points.cpu().double().numpy())).to(found)

    def bumps(self, points: Points) -> Float64[np.ndarray, " n"]:
        """What is taken off the field."""
        distance, nearest = map(np.asarray, self.tree.query(points, distance_upper_bound=self.radius))
        close = np.isfinite(distance)
        bumps = np.zeros(len(points))
        fall = 1.0 - (distance[close] / self.radius) ** 2
        bumps[close] = self.change[nearest[close]] * fall**2
        return bumps


def reach_of(points: Points, apart: float) -> float:
    """Half the greatest width of a handle that points of a surface do not bear out, unit lengths.

    apart: of the closest sheets that they tell apart, see `weingarten.scan.sheets.Sheets.apart`.
    """
    asked = points[:: max(1, len(points) // 5000)]
    spacing = float(np.median(KDTree(points).query(asked, k=2, workers=-1)[0][:, 1]))
    return min(SPACING * spacing, APART * apart, MOST)


def without_handles(
    mesh: Mesh, make: Callable[[Values], Mesh], values: Values, jets: Jets, reach: float, lattice: Lattice
) -> Mesh:
    """The mesh, or the one that has fewer handles and no more pieces.

    mesh: what `make` makes of the field's values on the lattice, unit frame. reach: see reach_of.
    """
    if topology(mesh).genus == 0:
        return mesh
    found = loose(saddles(mesh, values, jets, reach), values, lattice)
    if len(found.values):
        other = make(Mended(values, found, lattice.step))
        if simpler(other, mesh):
            return other
    return mesh


def loose(found: Saddles, values: Values, lattice: Lattice) -> Saddles:
    """Those that take a handle, or part a piece, of what the lattice sees, mended one after the other.

    That is where the Euler characteristic of the inside grows by one. The change of a saddle is told from the
    nodes about it, but for those within its radius of an earlier one: a handle has many critical points.
    """
    kept = np.zeros(len(found.values), dtype=bool)
    side = 2 * AROUND + 1
    about = np.indices((side,) * 3).reshape(3, -1).T - AROUND
    nodes = np.round(lattice.places(found.places))[:, None] + about
    blocks = lattice.positions(nodes.reshape(-1, 3))
    own = at(values, blocks).reshape(-1, len(about))
    blocks = blocks.reshape(-1, len(about), 3)
    for i, place in enumerate(found.places):
        if kept.any() and cdist(found.places[kept], place[None]).min() < WIDTH * lattice.step:
            continue
        eulers = []
        for chosen in (kept, kept | (np.arange(len(kept)) == i)):
            bumps = Mended(values, found.of(chosen), lattice.step).bumps(blocks[i]) if chosen.any() else 0.0
            eulers.append(euler((own[i] - bumps < 0.0).reshape((side,) * 3)))
        kept[i] = eulers[1] == eulers[0] + 1
    return found.of(kept)


def euler(inside: Bool[np.ndarray, "x y z"]) -> int:
    """Nodes − edges + squares − cubes of a lattice, of those that have all corners inside."""
    found = 0
    for way in product((False, True), repeat=3):
        within = inside
        for axis in np.flatnonzero(way):
            ahead = np.moveaxis(within, axis, 0)
            within = np.moveaxis(ahead[1:] & ahead[:-1], 0, axis)
        found += (-1) ** sum(way) * int(within.sum())
    return found


def simpler(mesh: Mesh, than: Mesh) -> bool:
    """Whether a mesh has fewer handles than another, is as closed and in no more pieces."""
    ours, theirs = topology(mesh), topology(than)
    if ours.genus is None or theirs.genus is None:
        return False
    return ours.genus < theirs.genus and ours.components <= theirs.components


def saddles(mesh: Mesh, values: Values, jets: Jets, reach: float) -> Saddles:
    """Those with |f| below the reach, of tunnels and bridges that the mesh has, by Newton's method."""
    places = starts = narrow(mesh, values, reach)
    if not 0 < len(starts) <= MOST_STARTS:
        return Saddles(np.empty((0, 3)), np.empty(0))
    for _ in range(STEPS):
        step = newton(places, jets)
        length = np.linalg.norm(step, axis=1, keepdims=True)
        places = places + step * np.minimum(1.0, STRIDE * reach / np.maximum(length, 1e-12))
    value, slope, hessian = second_order(places, jets)
    negative = (np.linalg.eigvalsh(hessian) < 0.0).sum(axis=1)
    found = (np.linalg.norm(slope, axis=1) < FLAT) & (np.abs(value) < reach)
    found &= np.linalg.norm(places - starts, axis=1) < FAR * reach
    found &= negative == np.where(value > 0.0, 2, 1)
    order = np.flatnonzero(found)[np.argsort(np.abs(value[found]), kind="stable")]
    cubes = np.round(places[order] / (SAME * reach)).astype(np.int64)
    order = order[np.sort(np.unique(cubes, axis=0, return_index=True)[1])]
    return Saddles(places[order], value[order])


def narrow(mesh: Mesh, values: Values, reach: float) -> Points:
    """One place in each cube of side `reach` of those midway to another side, in and out of the mesh."""
    normals = np.nan_to_num(igl.per_vertex_normals(mesh.vertices, mesh.faces))
    surface = np.abs(at(values, mesh.vertices)) < reach  # the others close the mesh at the box's sides
    places = [np.empty((0, 3))]
    for sign in (-1.0, 1.0):
        beyond = sign * at(values, mesh.vertices + 2.0 * sign * reach * normals)
        close = surface & (beyond < TURNED * reach)
        ways = mesh.vertices[close] + SHARES[:, None, None] * 2.0 * sign * reach * normals[close]
        heights = sign * at(values, ways.reshape(-1, 3)).reshape(len(SHARES), -1)
        highest = np.take_along_axis(ways, heights.argmax(axis=0)[None, :, None], axis=0)[0]
        most = heights.max(axis=0)
        places.append(highest[(most < reach) & (beyond[close] < TURNED * most)])
    found = np.concatenate(places)
    return found[np.unique(np.round(found / reach).astype(np.int64), axis=0, return_index=True)[1]]


def at(values: Values, places: Points) -> Float64[np.ndarray, " n"]:
    """The field there."""
    if not len(places):
        return np.empty(0)
    return values(torch.from_numpy(places.astype(np.float32))).cpu().double().numpy()


def newton(places: Points, jets: Jets) -> Points:
    """−H⁻¹∇f, H's eigenvalues kept away from zero."""
    _, slope, hessian = second_order(places, jets)
    values, vectors = np.linalg.eigh(hessian)
    stiff = np.where(values < 0.0, -1.0, 1.0) * np.maximum(np.abs(values), STIFFEST)
    along = np.einsum("nij,ni->nj", vectors, slope) / stiff
    return -np.einsum("nij,nj->ni", vectors, along)


def second_order(
    places: Points, jets: Jets
) -> tuple[Float64[np.ndarray, " n"], Points, Float64[np.ndarray, "n 3 3"]]:
    """f, ∇f and H in the axes of the unit frame."""
    jet = jets(places, HESSIAN)
    angles = jet.value.new_zeros(len(places))
    frame = torch.stack(directions(jet.slope, angles, HESSIAN), dim=-1)
    hessian = frame @ jet.hessian @ frame.transpose(-1, -2)
    return jet.value.double().numpy(), jet.slope.double().numpy(), hessian.double().numpy()

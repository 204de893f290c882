"""More vertices where colours between vertices would be wrong: what is drawn in 3D is interpolated.

A flat face of a part has vertices on its edges alone, which is where errors are large; interpolated, the
whole face would seem wrong.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from weingarten.mesh import Mesh
from weingarten.metrics.topology import edge_ends, edge_keys

Points = Float64[np.ndarray, "_ 3"]
Levels = Float64[np.ndarray, "_ k"]
LevelsAt = Callable[[Points], Levels]

ROUNDS = 12
TOLERANCE = 16.0
"""Levels that a place on an edge may be wrong by."""
PLACES = np.array([0.125, 0.25, 0.5, 0.75, 0.875])
"""Of an edge, from one end to the other: where it is looked at, and where it may be cut."""
FARTHEST = 2**31


@dataclass(frozen=True)
class Edges:
    """What is known of edges, by ascending key. place: on PLACES, the best one to cut at. level: there.

    wrong: how far each level is from that between the ends, at most of all places.
    """

    key: Int64[np.ndarray, " e"]
    place: Int64[np.ndarray, " e"]
    wrong: Float64[np.ndarray, "e k"]
    level: Float64[np.ndarray, "e k"]


def refined(mesh: Mesh, most: int, levels_at: LevelsAt) -> tuple[Mesh, Levels]:
    """The same surface, and its levels, with edges cut where levels are not those between the ends.

    levels_at: any number of levels of n places, (n, k). Edges are cut worst first, for both of their faces or
    for neither, so that no gap opens, up to about `most` triangles.
    """
    levels = levels_at(mesh.vertices)
    none = np.zeros(0, dtype=np.int64)
    known = Edges(none, none, levels[:0], levels[:0])
    for _ in range(ROUNDS):
        pairs, which = edges_of(mesh)
        known = looked_at(mesh, levels, pairs, known, levels_at)
        cuts = worst(needs(mesh, pairs, known.wrong), (most - len(mesh.faces)) // 2)
        if not cuts.any():
            break
        mesh = cut(mesh, pairs, which, cuts, PLACES[known.place])
        levels = np.concatenate([levels, known.level[cuts]])
    return mesh, levels


def needs(
    mesh: Mesh, pairs: Int64[np.ndarray, "e 2"], wrong: Float64[np.ndarray, "e k"]
) -> Float64[np.ndarray, " e"]:
    """How much every edge should be cut: error times length, and the shares of all levels added.

    Each level has the same to share out, so that one that is noise everywhere leaves the others theirs.
    """
    length = np.linalg.norm(mesh.vertices[pairs[:, 1]] - mesh.vertices[pairs[:, 0]], axis=1)
    need = np.where(wrong > TOLERANCE, wrong, 0.0) * length[:, None]
    total = need.sum(axis=0)
    return np.divide(need, total, out=np.zeros_like(need), where=total > 0).sum(axis=1)


def looked_at(
    mesh: Mesh, levels: Levels, pairs: Int64[np.ndarray, "e 2"], known: Edges, levels_at: LevelsAt
) -> Edges:
    """What is known of a mesh's edges; those known before are not looked at again."""
    key = pairs[:, 0] * FARTHEST + pairs[:, 1]
    at = np.searchsorted(known.key, key)
    old = np.zeros(len(key), dtype=bool)
    old[at < len(known.key)] = known.key[at[at < len(known.key)]] == key[at < len(known.key)]
    place = np.zeros(len(key), dtype=np.int64)
    wrong, level = (np.zeros((len(key), levels.shape[1])) for _ in range(2))
    place[old], wrong[old], level[old] = (own[at[old]] for own in (known.place, known.wrong, known.level))
    place[~old], wrong[~old], level[~old] = examined(mesh, levels, pairs[~old], levels_at)
    return Edges(key, place, wrong, level)


def examined(
    mesh: Mesh, levels: Levels, pairs: Int64[np.ndarray, "e 2"], levels_at: LevelsAt
) -> tuple[Int64[np.ndarray, " e"], Float64[np.ndarray, "e k"], Float64[np.ndarray, "e k"]]:
    """Place, wrong and level (see Edges) of edges: the best cut leaves the least error at all places."""
    count = len(PLACES)
    start, stop = mesh.vertices[pairs[:, 0], None], mesh.vertices[pairs[:, 1], None]
    points = start + PLACES[:, None] * (stop - start)
    true = levels_at(points.reshape(-1, 3)).reshape(len(pairs), count, levels.shape[1])
    first, last = levels[pairs[:, 0], None], levels[pairs[:, 1], None]
    whole = np.abs(true - (first + PLACES[:, None] * (last - first)))
    wrong = whole.max(axis=1)
    left = np.zeros((len(pairs), count))
    for k, place in enumerate(PLACES):
        before = np.clip(PLACES / place, 0.0, 1.0)[:, None]
        after = np.clip((PLACES - place) / (1 - place), 0.0, 1.0)[:, None]
        middle = true[:, k : k + 1]
        shown = np.where(
            PLACES[:, None] < place, first + before * (middle - first), middle + after * (last - middle)
        )
        left[:, k] = np.abs(true - shown).sum(axis=(1, 2))
    best = left.argmin(axis=1)
    return best, wrong, true[np.arange(len(pairs)), best]


def edges_of(mesh: Mesh) -> tuple[Int64[np.ndarray, "e 2"], Int64[np.ndarray, "f 3"]]:
    """The ends of every edge, and of every face the edges from each of its corners to the next."""
    _, at, which = np.unique(edge_keys(mesh.faces), return_index=True, return_inverse=True)
    return edge_ends(mesh.faces, at), which.reshape(-1, 3)


def worst(values: Float64[np.ndarray, " e"], most: int) -> Bool[np.ndarray, " e"]:
    """The `most` greatest of those above zero."""
    order = np.argsort(-values, kind="stable")[: max(most, 0)]
    chosen = np.zeros(len(values), dtype=bool)
    chosen[order] = values[order] > 0
    return chosen


def cut(
    mesh: Mesh,
    pairs: Int64[np.ndarray, "e 2"],
    which: Int64[np.ndarray, "f 3"],
    cuts: Bool[np.ndarray, " e"],
    places: Float64[np.ndarray, " e"],
) -> Mesh:
    """Chosen edges get a vertex at their place, after all others; faces are cut into two, three or four."""
    number = np.where(cuts, len(mesh.vertices) + np.cumsum(cuts) - 1, -1)
    start, stop = mesh.vertices[pairs[cuts, 0]], mesh.vertices[pairs[cuts, 1]]
    vertices = np.concatenate([mesh.vertices, start + places[cuts, None] * (stop - start)])
    return Mesh(vertices, _cut(mesh.faces, number[which], vertices))


def _cut(
    faces: Int64[np.ndarray, "f 3"], middle: Int64[np.ndarray, "f 3"], vertices: Float64[np.ndarray, "v 3"]
) -> Int64[np.ndarray, "g 3"]:
    """Faces cut at vertices on their edges; middle[:, k]: the one between corners k and k + 1, or −1."""
    count = (middle >= 0).sum(axis=1)
    first = np.where(count == 2, (np.argmin(middle, axis=1) + 1) % 3, np.argmax(middle >= 0, axis=1))
    turn = (first[:, None] + np.arange(3)) % 3
    faces, middle = np.take_along_axis(faces, turn, axis=1), np.take_along_axis(middle, turn, axis=1)
    a, b, c = faces.T
    p, q, r = middle.T
    one, two, three = count == 1, count == 2, count == 3
    across = np.linalg.norm(vertices[a] - vertices[q], axis=1) < np.linalg.norm(
        vertices[p] - vertices[c], axis=1
    )
    here, there = two & across, two & ~across
    parts = [
        (count == 0, [(a, b, c)]),
        (one, [(a, p, c), (p, b, c)]),
        (two, [(p, b, q)]),
        (here, [(a, p, q), (a, q, c)]),
        (there, [(a, p, c), (p, q, c)]),
        (three, [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]),
    ]
    return np.concatenate([np.stack(own, axis=1)[mask] for mask, pieces in parts for own in pieces])

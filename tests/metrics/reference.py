"""Both protocols once more, slow and plain: every point against every triangle, sharp edges by a dictionary.

Of the package they use only the points that are drawn, whose uniformity tests/scan/test_sampling.py has, and
where several faces are equally near, the one that the package chose, having made sure that it is one of them.
"""

import numpy as np
import trimesh

from weingarten.mesh import Mesh
from weingarten.metrics.distance import closest
from weingarten.metrics.edges import sample_edges, sharp_edges
from weingarten.scan.sampling import sample_surface

TIE = 1e-9


def centred(mesh: Mesh, by: Mesh) -> Mesh:
    """With the box of `by` about the origin, its longest side 1."""
    low, high = (end([by.vertices[i] for face in by.faces for i in face], axis=0) for end in (np.min, np.max))
    return Mesh((mesh.vertices - (low + high) / 2) / max(high - low), mesh.faces)


def normals(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    across = np.cross(c - b, a - b)
    return across / np.sqrt((across**2).sum(axis=1, keepdims=True))


def segment_distances(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(n, e) from n points to e segments."""
    along = end - start
    offset = points[:, None] - start
    share = (offset * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-300)
    return np.linalg.norm(offset - share.clip(0, 1)[..., None] * along, axis=2)


def triangle_distances(points: np.ndarray, mesh: Mesh) -> np.ndarray:
    """(n, f): to the plane where the foot of the perpendicular is inside all three edges, else to an edge."""
    corners, normal = mesh.vertices[mesh.faces], normals(mesh)
    height = ((points[:, None] - corners[:, 0]) * normal).sum(axis=2)
    foot = points[:, None] - height[..., None] * normal
    within, nearest = np.ones(height.shape, dtype=bool), np.full(height.shape, np.inf)
    for k in range(3):
        start, end = corners[:, k], corners[:, (k + 1) % 3]
        within &= (np.cross(end - start, foot - start) * normal).sum(axis=2) >= 0
        nearest = np.minimum(nearest, segment_distances(points, start, end))
    return np.where(within, np.abs(height), nearest)


def one_way(source: Mesh, target: Mesh, count: int, stream: int) -> tuple[np.ndarray, np.ndarray]:
    """Distances of the source's samples to the target, and |a · b| there."""
    points, faces = sample_surface(source, count, (0, stream))
    chosen = closest(target, points).face
    distances, mine, its = np.empty(count), normals(source), normals(target)
    agreement = np.empty(count)
    for i in range(0, count, 25):
        matrix = triangle_distances(points[i : i + 25], target)
        distances[i : i + 25] = matrix.min(axis=1)
        ties = matrix[np.arange(len(matrix)), chosen[i : i + 25]]
        assert (ties - matrix.min(axis=1) < TIE).all()
        agreement[i : i + 25] = np.abs((mine[faces[i : i + 25]] * its[chosen[i : i + 25]]).sum(axis=1))
    return distances, agreement


def edge_list(mesh: Mesh) -> set[frozenset[tuple[float, ...]]]:
    """The sharp edges, as pairs of positions."""
    around: dict[frozenset[tuple[float, ...]], list[np.ndarray]] = {}
    for face, normal in zip(mesh.faces, normals(mesh), strict=True):
        corners = [tuple(mesh.vertices[i].tolist()) for i in face]
        for k in range(3):
            around.setdefault(frozenset((corners[k], corners[(k + 1) % 3])), []).append(normal)
    limit = np.cos(np.radians(30))
    return {edge for edge, both in around.items() if len(both) != 2 or both[0] @ both[1] <= limit}


def edges_one_way(source: Mesh, target: Mesh, count: int, stream: int) -> np.ndarray:
    drawn = sharp_edges(source)
    assert {frozenset((tuple(a), tuple(b))) for a, b in drawn.tolist()} == edge_list(source)
    ends = np.array([sorted(edge) for edge in edge_list(target)])
    return segment_distances(sample_edges(drawn, count, (0, stream)), ends[:, 0], ends[:, 1]).min(axis=1)


def quantile(values: np.ndarray, share: float) -> float:
    """Between the two order statistics next to share · (n − 1), in proportion."""
    ordered = sorted(values.tolist())
    place = share * (len(ordered) - 1)
    low = int(place)
    return ordered[low] + (place - low) * (ordered[min(low + 1, len(ordered) - 1)] - ordered[low])


def f_score(forth: np.ndarray, back: np.ndarray, threshold: float) -> float:
    precision, recall = (sum(d < threshold for d in side) / len(side) for side in (forth, back))
    return 2 / (1 / precision + 1 / recall) if precision and recall else 0.0


def average(forth: np.ndarray, back: np.ndarray) -> float:
    return (sum(forth) / len(forth) + sum(back) / len(back)) / 2


def exact(mesh: Mesh, truth: Mesh, count: int, edge_count: int) -> dict[str, float | int | bool]:
    """The figures of exact-1 at seed 0."""
    made, true = centred(mesh, truth), centred(truth, truth)
    (forth, a), (back, b) = one_way(made, true, count, 0), one_way(true, made, count, 1)
    along, backward = edges_one_way(made, true, edge_count, 2), edges_one_way(true, made, edge_count, 3)
    mine, its = (trimesh.Trimesh(m.vertices, m.faces, process=False) for m in (made, true))
    both = np.concatenate([forth, back])
    return {
        "chamfer": average(forth, back),
        "distance_95": quantile(both, 0.95),
        "hausdorff": max(both),
        "f1_005": f_score(forth, back, 0.005),
        "f1_001": f_score(forth, back, 0.001),
        "normal_consistency": average(a, b),
        "edge_chamfer": average(along, backward),
        "edge_f1": f_score(along, backward, 0.005),
        "volume_ratio": mine.volume / its.volume,
        "watertight": mine.is_watertight,
        "truth_watertight": its.is_watertight,
        "components": mine.body_count,
        "truth_components": its.body_count,
        "euler": mine.euler_number,
        "truth_euler": its.euler_number,
        "genus": 1 - mine.euler_number // 2,
        "truth_genus": 1 - its.euler_number // 2,
        "unit_length": max(np.ptp(truth.vertices[truth.faces].reshape(-1, 3), axis=0)),
    }


def published(mesh: Mesh, truth: Mesh, count: int) -> dict[str, float]:
    """The figures of published-1 at seed 0, from the full matrix of distances."""
    clouds = []
    for stream, one in enumerate((mesh, truth)):
        points, faces = sample_surface(centred(one, one), count, (0, stream))
        clouds.append((points, normals(centred(one, one))[faces]))
    (p, a), (q, b) = clouds
    matrix = np.sqrt(sum((p[:, None, k] - q[None, :, k]) ** 2 for k in range(3)))
    forth, back = matrix.min(axis=1), matrix.min(axis=0)
    return {
        "chamfer": average(forth, back),
        "f1": f_score(forth, back, 0.005),
        "normal_consistency": average(
            np.abs(a * b[matrix.argmin(axis=1)]).sum(axis=1), np.abs(b * a[matrix.argmin(axis=0)]).sum(axis=1)
        ),
    }

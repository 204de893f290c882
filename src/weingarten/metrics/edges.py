"""Sharp edges of a mesh, from the angles between its faces, and how far those of two meshes are apart."""

import igl
import numpy as np
from jaxtyping import Float64, Int64

from weingarten.io.coincident import coincident
from weingarten.mesh import Mesh
from weingarten.metrics.normals import face_normals
from weingarten.metrics.topology import edge_ends, edge_keys, half_edge_pairs
from weingarten.scan.sampling import Points, Seed, generator

SHARP = float(np.radians(30.0))
"""Least angle between the normals of two faces at a sharp edge; less belongs to a curved surface."""

Edges = Float64[np.ndarray, "e 2 3"]


def sharp_edges(mesh: Mesh, angle: float = SHARP) -> Edges:
    """The ends of every edge at which the surface turns by `angle` or more, or ends; in the mesh's frame.

    angle: radians, between outward normals. An edge of more than two faces is sharp. Faces without area are
    left out, and vertices at equal positions are one.
    """
    solid = Mesh(mesh.vertices, mesh.faces[mesh.areas > 0])
    first, same = coincident(solid.vertices)
    faces, normals = same[solid.faces], face_normals(solid)
    keys = edge_keys(faces)
    _, at, edge, uses = np.unique(keys, return_index=True, return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    one, other = half_edge_pairs(edge)
    turned = np.einsum("ni,ni->n", normals[one // 3], normals[other // 3]) <= np.cos(angle)
    sharp = uses != 2
    sharp[edge[one[turned]]] = True
    return solid.vertices[first][edge_ends(faces, at[sharp])]


def lengths(edges: Edges) -> Float64[np.ndarray, " e"]:
    """Length of every edge."""
    return np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)


def sample_edges(edges: Edges, count: int, seed: Seed) -> Points:
    """`count` points uniform by length on the edges, of which there is at least one with a length."""
    cumulative, draw = np.cumsum(lengths(edges)), generator(seed)
    at = draw.random(count) * cumulative[-1]
    chosen = np.minimum(np.searchsorted(cumulative, at, side="right"), len(edges) - 1)
    along = draw.random(count)[:, None]
    return (1 - along) * edges[chosen, 0] + along * edges[chosen, 1]


def distance_to_edges(points: Points, edges: Edges) -> Float64[np.ndarray, " n"]:
    """min over the edges of ‖p − q‖, q on the edge, for every point p, in the frame of both."""
    ends: Int64[np.ndarray, "e 2"] = np.arange(2 * len(edges), dtype=np.int64).reshape(-1, 2)
    _, _, nearest = igl.point_mesh_squared_distance(
        np.ascontiguousarray(points), np.ascontiguousarray(edges.reshape(-1, 3)), ends
    )
    return np.linalg.norm(points - nearest, axis=1)

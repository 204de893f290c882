"""Screened Poisson reconstruction from estimated normals: what a practitioner does with unoriented points.

M. Kazhdan, H. Hoppe, *Screened Poisson surface reconstruction*, ACM Trans. Graph. 32(3), 2013, by the
authors' own code, which gpytoolbox wraps (extra `bench`). It needs oriented normals, which are estimated
here as by H. Hoppe et al., *Surface reconstruction from unorganized points*, SIGGRAPH 1992, §3.2–3.3.

The same points give the same mesh to the last bit: nothing is drawn at random, and the solver runs on one
thread.
"""

import warnings
from importlib.metadata import version
from types import ModuleType

import numpy as np
from jaxtyping import Float64, Int64
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree
from scipy.spatial import KDTree

from weingarten.errors import CloudError, FitError, OptionError
from weingarten.extras import required
from weingarten.frame import Frame
from weingarten.mesh import Mesh
from weingarten.metrics.topology import volume
from weingarten.scan.diagnose import diagnose
from weingarten.scan.normals import plane_normals

Points = Float64[np.ndarray, "n 3"]

NEIGHBOURS = 10
"""MeshLab's default. More of them round edges off and reach through thin walls to the other side."""

SCREENING = 4.0
"""α, the weight of the samples' own equation: the default of MeshLab and PCL."""

CUBE = 1.1
"""Side of the solver's cube over the longest side of the cloud's box, as in Kazhdan's program."""

ROOM, LEVELS = 3.2, 2
"""The same in gpytoolbox, which lets no one choose it. Depth d + 2 in a cube four times CUBE wide has the
cells of depth d in CUBE; so the box is made 4 CUBE / ROOM times as long (see `_in_larger_box`)."""

DEPTHS = range(3, 11)
"""Below, the solver warns that its coarsest full grid is finer; above, gpytoolbox stops at its depth 12."""


def screened_poisson(points: Points, depth: int = 8, neighbours: int = NEIGHBOURS) -> Mesh:
    """The screened Poisson surface of an unoriented cloud, in the cloud's frame (any).

        χ = argmin ∫ ‖∇χ − V‖² + α A/n Σ χ(pᵢ)²,

    V the smoothed field of the normals, A the surface's area, on an octree whose finest cells are
    1.1 L / 2^depth wide, L the longest side of the cloud's box. Points are taken as `diagnose` leaves them.
    The whole level set is returned: nothing is trimmed. It is closed unless the normals are so wrong that it
    leaves the solver's cube. A mesh of negative volume is turned inside out, because points do not tell the
    normals' common sign.

    neighbours: of `oriented_normals`. Raises OptionError for a depth outside 3 to 10 or fewer than 3
    neighbours; MissingExtraError without gpytoolbox; CloudError for points that are no part; FitError
    when there is no surface.
    """
    if depth not in DEPTHS:
        raise OptionError(f"The depth must be a whole number from {DEPTHS[0]} to {DEPTHS[-1]}; got {depth}.")
    library = _gpytoolbox()
    cloud = diagnose(points).points
    frame = Frame.of(cloud)
    unit = frame.to_unit(cloud)
    samples = _in_larger_box(unit, oriented_normals(unit, neighbours))
    try:
        vertices, faces = library.point_cloud_to_mesh(
            *samples, psr_screening_weight=SCREENING, psr_depth=depth + LEVELS
        )
    except RuntimeError as error:
        raise FitError(f"The screened Poisson solver failed on {len(unit)} points: {error}") from error
    if len(faces) == 0 or not np.isfinite(vertices).all():
        raise FitError(
            f"Screened Poisson reconstruction found no surface through the {len(unit)} points; "
            "try another depth or number of neighbours."
        )
    mesh = Mesh(np.ascontiguousarray(frame.to_world(vertices)), faces.astype(np.int64, order="C"))
    return Mesh(mesh.vertices, mesh.faces[:, ::-1].copy()) if volume(mesh) < 0 else mesh


def _in_larger_box(
    points: Points, normals: Points
) -> tuple[Float64[np.ndarray, "m 3"], Float64[np.ndarray, "m 3"]]:
    """Two corners more (m = n + 2), with normals of zero: the solver fits its cube to them, nothing else."""
    lowest, highest = points.min(axis=0), points.max(axis=0)
    half = 2**LEVELS * CUBE / ROOM * float((highest - lowest).max()) / 2
    corners = (lowest + highest) / 2 + half * np.array([[-1.0], [1.0]])
    return np.concatenate([points, corners]), np.concatenate([normals, np.zeros((2, 3))])


def oriented_normals(points: Points, neighbours: int = NEIGHBOURS) -> Points:
    """Unit normals of finite, distinct points in any frame, with signs that agree.

    nᵢ is the direction of least variance of the point and its nearest `neighbours`. Signs spread from point
    to point along a minimum spanning tree of the neighbour graph with weights 1 − |nᵢ · nⱼ|, each turned to
    nᵢ · nⱼ ≥ 0. Every connected component of the graph starts at its highest point, normal upward: outward
    on the outer side of a part, the wrong way round on a cavity of its own.

    Differs from the paper: the graph is that of the nearest neighbours alone, without the Euclidean minimum
    spanning tree that would connect its components. Raises OptionError for fewer than 3 neighbours,
    CloudError when there are no more points than neighbours.
    """
    if neighbours < 3:
        raise OptionError(f"A normal needs at least 3 neighbours; got {neighbours}.")
    if len(points) <= neighbours:
        raise CloudError(
            f"The cloud has {len(points)} points, too few for {neighbours} neighbours each; give more points."
        )
    near = np.asarray(KDTree(points).query(points, k=neighbours + 1, workers=-1)[1], dtype=np.int64)
    normals = plane_normals(points[near])[0]
    parents = _parents(_spanning_tree(normals, near[:, 1:]), points[:, 2])
    return normals * _signs(normals, parents)[:, None]


def _spanning_tree(normals: Points, near: Int64[np.ndarray, "n k"]) -> csr_matrix:
    """The edges of a minimum spanning tree (forest) of the neighbour graph, one way each.

    Each weight is raised by 1, which leaves the tree as it is: scipy takes a weight of 0 for no edge.
    """
    n, k = near.shape
    weights = 2.0 - np.abs(np.einsum("nd,nkd->nk", normals, normals[near]))
    graph = csr_matrix((weights.ravel(), near.ravel(), np.arange(0, n * k + 1, k)), shape=(n, n))
    return minimum_spanning_tree(graph)


def _parents(tree: csr_matrix, height: Float64[np.ndarray, " n"]) -> Int64[np.ndarray, " m"]:
    """The node before each on the way from node n, which is joined to the highest of every component.

    m = n + 1; node n is its own parent.
    """
    n = len(height)
    components, label = connected_components(tree, directed=False)
    order = np.lexsort((-height, label))
    highest = order[np.searchsorted(label[order], np.arange(components))]
    edges = tree.tocoo()
    start = np.concatenate([edges.row, np.full(components, n)])
    stop = np.concatenate([edges.col, highest])
    rooted = coo_matrix((np.ones(len(start)), (start, stop)), shape=(n + 1, n + 1))
    parents = breadth_first_order(rooted.tocsr(), n, directed=False)[1].astype(np.int64)
    parents[n] = n
    return parents


def _signs(normals: Points, parents: Int64[np.ndarray, " m"]) -> Float64[np.ndarray, " n"]:
    """±1 for every normal, so that each agrees with its parent's, and those of node n's children point up.

    The product of the relative signs on the way to node n, by pointer jumping: each round multiplies by the
    product that the ancestor has gathered and doubles the step, log₂ of the tree's depth rounds in all.
    """
    n = len(normals)
    rooted = np.concatenate([normals, [[0.0, 0.0, 1.0]]])
    signs = np.where(np.einsum("md,md->m", rooted, rooted[parents]) < 0, -1.0, 1.0)
    while (parents != n).any():
        signs, parents = signs * signs[parents], parents[parents]
    return signs[:n]


def solver() -> str:
    """The library and its version, for a record. Raises MissingExtraError without it."""
    return f"gpytoolbox {version(_gpytoolbox().__name__)}"


def _gpytoolbox() -> ModuleType:
    """The library, whose import alone warns of what numpy and scipy will drop: nothing a user can mend."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return required("gpytoolbox", "Screened Poisson reconstruction needs", "bench")

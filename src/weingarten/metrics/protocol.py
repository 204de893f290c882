"""Named, versioned ways of comparing a mesh with the truth; a figure without its protocol means nothing.

Lengths are in unit-cube lengths: the box's centre at the origin, its longest side 1. `published-1` is what
the field's tables use (method §6), with the weaknesses described at `Published`; `exact-1` is the default.
Any change that moves a figure beyond its sampling noise gets a new number.
"""

from dataclasses import asdict, dataclass, field, fields

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from weingarten.errors import InputError
from weingarten.mesh import Mesh
from weingarten.metrics.distance import Closest, closest
from weingarten.metrics.edges import distance_to_edges, sample_edges, sharp_edges
from weingarten.metrics.normals import alignment, elementwise_alignment, face_normals
from weingarten.metrics.topology import topology
from weingarten.scan.sampling import sample_surface

Values = Float64[np.ndarray, " n"]

LENGTH = {"unit": "×10⁻³ unit-cube lengths", "factor": 1e3}
SHARE = {"unit": "%", "factor": 1e2}
MESH_STREAM, TRUTH_STREAM, MESH_EDGE_STREAM, TRUTH_EDGE_STREAM = range(4)


@dataclass(frozen=True)
class Figure:
    """One figure ready for print: value = raw value × factor (a count or a truth value stays as it is)."""

    name: str
    label: str
    value: float | int | bool | None
    unit: str


@dataclass(frozen=True)
class Figures:
    """Named figures of one comparison, raw: lengths in unit-cube lengths, shares in [0, 1]."""

    protocol: str

    def as_dict(self) -> dict[str, str | float | int | bool | None]:
        """Plain values by name, `protocol` first; None where a figure does not exist."""
        return asdict(self)

    def rows(self) -> list[Figure]:
        """The figures in order, scaled to the units in which the literature prints them."""
        rows = []
        for entry in fields(self):
            if "label" in entry.metadata:
                raw, factor = getattr(self, entry.name), entry.metadata.get("factor")
                value = raw if factor is None or raw is None else raw * factor
                rows.append(
                    Figure(entry.name, entry.metadata["label"], value, entry.metadata.get("unit", ""))
                )
        return rows


def _figure(label: str, unit: dict[str, str | float] | None = None):
    return field(metadata={"label": label, **(unit or {})})


@dataclass(frozen=True)
class PublishedFigures(Figures):
    """chamfer, f1 at 0.005, and the elementwise normal_consistency, all between two sets of samples."""

    chamfer: float = _figure("Chamfer distance", LENGTH)
    f1: float = _figure("F1 at 0.005", SHARE)
    normal_consistency: float = _figure("normal consistency (elementwise)", SHARE)


@dataclass(frozen=True)
class ExactFigures(Figures):
    """Distances between samples of one mesh and the triangles of the other, and the topology of both.

    hausdorff is the largest of the sampled distances, so a lower bound; volume_ratio is the mesh's enclosed
    volume over the truth's, None where the truth's is 0. edge_chamfer and edge_f1 are None where the truth
    has no sharp edge; where the mesh alone has none, edge_f1 is 0 and edge_chamfer None.
    """

    chamfer: float = _figure("Chamfer distance", LENGTH)
    distance_95: float = _figure("95th percentile of the distance", LENGTH)
    hausdorff: float = _figure("Hausdorff distance (sampled)", LENGTH)
    f1_005: float = _figure("F1 at 0.005", SHARE)
    f1_001: float = _figure("F1 at 0.001", SHARE)
    normal_consistency: float = _figure("normal consistency", SHARE)
    edge_chamfer: float | None = _figure("Chamfer distance of sharp edges", LENGTH)
    edge_f1: float | None = _figure("F1 of sharp edges at 0.005", SHARE)
    volume_ratio: float | None = _figure("volume, mesh / truth")
    watertight: bool = _figure("watertight, mesh")
    truth_watertight: bool = _figure("watertight, truth")
    components: int = _figure("components, mesh")
    truth_components: int = _figure("components, truth")
    euler: int = _figure("Euler number, mesh")
    truth_euler: int = _figure("Euler number, truth")
    genus: int | None = _figure("genus, mesh")
    truth_genus: int | None = _figure("genus, truth")


@dataclass(frozen=True)
class Published:
    """The protocol of the published tables.

    Each mesh is moved and scaled by its *own* bounding box to the unit cube (longest side 1, sides keep
    their ratio), so that an error of size or place is forgiven. 100,000 area-weighted samples a side; d₁,
    d₂ the Euclidean distances to the nearest sample of the other side; CD = ½ (mean d₁ + mean d₂);
    F1 at τ = 0.005 from precision and recall P(d < τ); NC = ½ (mean₁ + mean₂) of Σᵢ |aᵢ bᵢ| of the face
    normals of each sample and its nearest, which is not |a · b| and changes when both meshes turn.

    Even a perfect mesh scores CD ≈ ½ √(A/N), F1 ≈ 1 − exp(−π τ² N / A), A the area in the unit cube;
    `ceiling` measures that.
    """

    name: str = "published-1"
    samples: int = 100_000
    threshold: float = 0.005

    def evaluate(self, mesh: Mesh, truth: Mesh, seed: int = 0) -> PublishedFigures:
        """Compare two meshes, each in any frame. Raises InputError when one has no surface."""
        points, normals = self._cloud(mesh, seed, MESH_STREAM)
        true_points, true_normals = self._cloud(truth, seed, TRUTH_STREAM)
        to_truth, match = KDTree(true_points).query(points, workers=-1)
        to_mesh, true_match = KDTree(points).query(true_points, workers=-1)
        return PublishedFigures(
            protocol=self.name,
            chamfer=_mean_of_means(to_truth, to_mesh),
            f1=f1(to_truth, to_mesh, self.threshold),
            normal_consistency=_mean_of_means(
                elementwise_alignment(normals, true_normals[match]),
                elementwise_alignment(true_normals, normals[true_match]),
            ),
        )

    def ceiling(self, truth: Mesh, seed: int = 0) -> PublishedFigures:
        """What the truth scores against an independent sample of itself: no mesh can be expected above."""
        return self.evaluate(truth, truth, seed)

    def _cloud(self, mesh: Mesh, seed: int, stream: int):
        unit = unit_cube(mesh, mesh)
        points, faces = sample_surface(unit, self.samples, (seed, stream))
        return points, face_normals(unit)[faces]


@dataclass(frozen=True)
class Exact:
    """Distances to triangles, in the truth's frame.

    One similarity, which takes the *truth's* bounding box to the unit cube (longest side 1), is applied to
    both meshes. d₁ are the distances of 100,000 area-weighted samples of the mesh to the truth's triangles,
    d₂ the reverse. CD = ½ (mean d₁ + mean d₂); 95th percentile and maximum over d₁ ∪ d₂; F1 at τ = 0.005
    and 0.001 from precision P(d₁ < τ) and recall P(d₂ < τ); NC = ½ (mean₁ + mean₂) of |a · b|, a the normal
    of the sample's face and b that of the face with the closest point. A perfect mesh scores 0, 1 and, but
    for samples on an edge, 1. CD and F1 at 0.005 of the sharp edges likewise, of 20,000 points uniform by
    length on those where a mesh turns by 30° or more.
    """

    name: str = "exact-1"
    samples: int = 100_000
    thresholds: tuple[float, float] = (0.005, 0.001)
    edge_samples: int = 20_000

    def evaluate(self, mesh: Mesh, truth: Mesh, seed: int = 0) -> ExactFigures:
        """Compare two meshes given in one common frame. Raises InputError when one has no surface."""
        made, true = unit_cube(mesh, truth), unit_cube(truth, truth)
        forth, forth_alignment = self._one_way(made, true, (seed, MESH_STREAM))
        back, back_alignment = self._one_way(true, made, (seed, TRUTH_STREAM))
        both = np.concatenate([forth.distance, back.distance])
        loose, tight = self.thresholds
        mine, its = topology(made), topology(true)
        edge_chamfer, edge_f1 = self._edges(made, true, seed)
        return ExactFigures(
            protocol=self.name,
            chamfer=_mean_of_means(forth.distance, back.distance),
            distance_95=float(np.percentile(both, 95)),
            hausdorff=float(both.max()),
            f1_005=f1(forth.distance, back.distance, loose),
            f1_001=f1(forth.distance, back.distance, tight),
            normal_consistency=_mean_of_means(forth_alignment, back_alignment),
            edge_chamfer=edge_chamfer,
            edge_f1=edge_f1,
            volume_ratio=mine.volume / its.volume if its.volume else None,
            watertight=mine.watertight,
            truth_watertight=its.watertight,
            components=mine.components,
            truth_components=its.components,
            euler=mine.euler,
            truth_euler=its.euler,
            genus=mine.genus,
            truth_genus=its.genus,
        )

    def _edges(self, made: Mesh, true: Mesh, seed: int) -> tuple[float | None, float | None]:
        mine, its = sharp_edges(made), sharp_edges(true)
        if not len(its) or not len(mine):
            return None, 0.0 if len(its) else None
        forth = distance_to_edges(sample_edges(mine, self.edge_samples, (seed, MESH_EDGE_STREAM)), its)
        back = distance_to_edges(sample_edges(its, self.edge_samples, (seed, TRUTH_EDGE_STREAM)), mine)
        return _mean_of_means(forth, back), f1(forth, back, self.thresholds[0])

    def _one_way(self, source: Mesh, target: Mesh, seed: tuple[int, int]) -> tuple[Closest, Values]:
        points, faces = sample_surface(source, self.samples, seed)
        found = closest(target, points)
        return found, alignment(face_normals(source)[faces], face_normals(target)[found.face])


PUBLISHED = Published()
EXACT = Exact()
PROTOCOLS = {"published": PUBLISHED, "exact": EXACT}


def unit_cube(mesh: Mesh, reference: Mesh) -> Mesh:
    """The mesh moved and scaled as takes the reference's box centre to 0 and its longest side to 1.

    The box is that of the vertices which faces use. Raises InputError when it has no extent.
    """
    corners = reference.corners.reshape(-1, 3)
    if not len(corners):
        raise InputError("The mesh has no faces, so there is no surface to compare.")
    lowest, highest = corners.min(axis=0), corners.max(axis=0)
    scale = float((highest - lowest).max())
    if not (np.isfinite(scale) and scale > 0):
        raise InputError("The mesh's bounding box has no finite extent, so there is no surface to compare.")
    return Mesh((mesh.vertices - (lowest + highest) / 2) / scale, mesh.faces)


def f1(to_truth: Values, to_mesh: Values, threshold: float) -> float:
    """Harmonic mean of precision P(to_truth < τ) and recall P(to_mesh < τ); 0 when both are 0."""
    precision, recall = float((to_truth < threshold).mean()), float((to_mesh < threshold).mean())
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0


def _mean_of_means(first: Values, second: Values) -> float:
    return 0.5 * (float(first.mean()) + float(second.mean()))

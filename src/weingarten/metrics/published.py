"""The protocol of the published tables, `published-1`, with its weaknesses; see `Published`."""

from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from weingarten.mesh import Mesh
from weingarten.metrics.figures import LENGTH, SHARE, Figure, Figures, f1, figure, mean_of_means
from weingarten.metrics.findings import check_surface, pair_findings
from weingarten.metrics.normals import elementwise_alignment, face_normals
from weingarten.metrics.topology import topology
from weingarten.metrics.unit_cube import unit_cube
from weingarten.scan.sampling import sample_surface

Vectors = Float64[np.ndarray, "n 3"]

MESH_STREAM, TRUTH_STREAM = range(2)


@dataclass(frozen=True)
class PublishedFigures(Figures):
    """chamfer, f1 at 0.005, and the elementwise normal_consistency, all between two sets of samples.

    ceiling: the same of the truth against itself, where it was asked for (`Published.beside_ceiling`).
    """

    chamfer: float = figure("Chamfer distance", LENGTH)
    f1: float = figure("F1 at 0.005", SHARE)
    normal_consistency: float = figure("normal consistency (elementwise)", SHARE)
    ceiling: "PublishedFigures | None" = field(default=None, kw_only=True)

    def excess(self) -> dict[str, float]:
        """Every figure minus its ceiling: that of chamfer is above 0 and the others below, or nearly so."""
        if self.ceiling is None:
            return {}
        return {name: getattr(self, name) - getattr(self.ceiling, name) for name in self.values()}

    def as_dict(self) -> dict[str, object]:
        """Also `ceiling` and `excess`, by the figures' names, where there is a ceiling."""
        if self.ceiling is None:
            return super().as_dict()
        return super().as_dict() | {"ceiling": self.ceiling.values(), "excess": self.excess()}

    def rows(self) -> list[Figure]:
        """Each with its ceiling."""
        if self.ceiling is None:
            return super().rows()
        pairs = zip(super().rows(), self.ceiling.rows(), strict=True)
        return [replace(row, ceiling=best.value) for row, best in pairs]


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
        """Compare two meshes, each in any frame. Raises InputError, saying which, when one has no surface."""
        check_surface(truth, "truth")
        check_surface(mesh, "mesh")
        found = pair_findings(mesh, topology(mesh), truth, topology(truth))
        return replace(self._compare(mesh, truth, seed), findings=found)

    def ceiling(self, truth: Mesh, seed: int = 0) -> PublishedFigures:
        """What the truth scores against an independent sample of itself: no mesh can be expected above.

        Raises InputError when the truth has no surface.
        """
        check_surface(truth, "truth")
        return self._compare(truth, truth, seed)

    def beside_ceiling(self, mesh: Mesh, truth: Mesh, seed: int = 0) -> PublishedFigures:
        """As `evaluate`, with the ceiling of the truth at the same seed beside every figure."""
        return replace(self.evaluate(mesh, truth, seed), ceiling=self.ceiling(truth, seed))

    def _compare(self, mesh: Mesh, truth: Mesh, seed: int) -> PublishedFigures:
        points, normals = self._cloud(mesh, seed, MESH_STREAM)
        true_points, true_normals = self._cloud(truth, seed, TRUTH_STREAM)
        to_truth, match = KDTree(true_points).query(points, workers=-1)
        to_mesh, true_match = KDTree(points).query(true_points, workers=-1)
        return PublishedFigures(
            protocol=self.name,
            chamfer=mean_of_means(to_truth, to_mesh),
            f1=f1(to_truth, to_mesh, self.threshold),
            normal_consistency=mean_of_means(
                elementwise_alignment(normals, true_normals[match]),
                elementwise_alignment(true_normals, normals[true_match]),
            ),
        )

    def _cloud(self, mesh: Mesh, seed: int, stream: int) -> tuple[Vectors, Vectors]:
        unit = unit_cube(mesh, mesh)
        points, faces = sample_surface(unit, self.samples, (seed, stream))
        return points, face_normals(unit)[faces]


PUBLISHED = Published()

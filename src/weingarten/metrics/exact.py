"""The default protocol, `exact-1`: distances to triangles, in the truth's frame; see `Exact`."""

from dataclasses import dataclass

import numpy as np

from weingarten.mesh import Mesh
from weingarten.metrics.distance import Closest, closest
from weingarten.metrics.edges import distance_to_edges, sample_edges, sharp_edges
from weingarten.metrics.figures import (
    LENGTH,
    RATIO,
    SHARE,
    WORLD_LENGTH,
    Figures,
    Values,
    f1,
    figure,
    mean_of_means,
)
from weingarten.metrics.findings import check_surface, has_inside, pair_findings
from weingarten.metrics.normals import alignment, face_normals
from weingarten.metrics.topology import topology
from weingarten.metrics.unit_cube import cube_frame, unit_cube
from weingarten.scan.sampling import sample_surface

MESH_STREAM, TRUTH_STREAM, MESH_EDGE_STREAM, TRUTH_EDGE_STREAM = range(4)


@dataclass(frozen=True)
class ExactFigures(Figures):
    """Distances between samples of one mesh and the triangles of the other, and the topology of both.

    hausdorff is the largest of the sampled distances, so a lower bound; volume_ratio is the volume that the
    mesh encloses over that of the truth, None unless both have an inside (`findings.has_inside`).
    edge_chamfer and edge_f1 are None where the truth has no sharp edge; where the mesh alone has none,
    edge_f1 is 0 and edge_chamfer None. unit_length, the longest side of the truth's box, is what a
    unit-cube length is in the unit of the input.
    """

    chamfer: float = figure("Chamfer distance", LENGTH)
    distance_95: float = figure("95th percentile of the distance", LENGTH)
    hausdorff: float = figure("Hausdorff distance (sampled)", LENGTH)
    f1_005: float = figure("F1 at 0.005", SHARE)
    f1_001: float = figure("F1 at 0.001", SHARE)
    normal_consistency: float = figure("normal consistency", SHARE)
    edge_chamfer: float | None = figure("Chamfer distance of sharp edges", LENGTH)
    edge_f1: float | None = figure("F1 of sharp edges at 0.005", SHARE)
    volume_ratio: float | None = figure("volume, mesh / truth", RATIO)
    watertight: bool = figure("watertight, mesh")
    truth_watertight: bool = figure("watertight, truth")
    components: int = figure("components, mesh")
    truth_components: int = figure("components, truth")
    euler: int = figure("Euler number, mesh")
    truth_euler: int = figure("Euler number, truth")
    genus: int | None = figure("genus, mesh")
    truth_genus: int | None = figure("genus, truth")
    unit_length: float = figure("unit-cube length", WORLD_LENGTH)


@dataclass(frozen=True)
class Exact:
    """Distances to triangles, in the truth's frame.

    One similarity, which takes the *truth's* bounding box to the unit cube (longest side 1), is applied to
    both meshes. d₁ are the distances of 100,000 area-weighted samples of the mesh to the truth's triangles,
    d₂ the reverse. CD = ½ (mean d₁ + mean d₂); 95th percentile and maximum over d₁ ∪ d₂; F1 at τ = 0.005
    and 0.001 from precision P(d₁ < τ) and recall P(d₂ < τ); NC = ½ (mean₁ + mean₂) of |a · b|, a the normal
    of the sample's face and b that of the face with the closest point, any one of them where that point is
    on an edge. A perfect mesh scores 0, 1 and, but for samples on an edge, 1. CD and F1 at 0.005 of the
    sharp edges likewise, of 20,000 points uniform by length on those where a mesh turns by 30° or more.

    Moving or scaling both meshes, or turning both by a right angle about an axis, changes nothing but
    unit_length, beyond rounding, which also decides which face is asked at an edge and so moves NC within its
    sampling noise. Any other turn changes the truth's box and with it the unit: lengths × unit_length stay,
    and all else but the F1, whose thresholds are in that unit.
    """

    name: str = "exact-1"
    samples: int = 100_000
    thresholds: tuple[float, float] = (0.005, 0.001)
    edge_samples: int = 20_000

    def evaluate(self, mesh: Mesh, truth: Mesh, seed: int = 0) -> ExactFigures:
        """Compare two meshes given in one common frame.

        Raises InputError, saying which of the two, when one has no surface. Whatever else is odd about them
        is among the findings of the figures.
        """
        check_surface(truth, "truth")
        check_surface(mesh, "mesh")
        made, true = unit_cube(mesh, truth), unit_cube(truth, truth)
        forth, forth_alignment = self._one_way(made, true, (seed, MESH_STREAM))
        back, back_alignment = self._one_way(true, made, (seed, TRUTH_STREAM))
        both = np.concatenate([forth.distance, back.distance])
        loose, tight = self.thresholds
        mine, its = topology(made), topology(true)
        solid = has_inside(made, mine) and has_inside(true, its)
        edge_chamfer, edge_f1 = self._edges(made, true, seed)
        return ExactFigures(
            protocol=self.name,
            findings=pair_findings(made, mine, true, its),
            chamfer=mean_of_means(forth.distance, back.distance),
            distance_95=float(np.percentile(both, 95)),
            hausdorff=float(both.max()),
            f1_005=f1(forth.distance, back.distance, loose),
            f1_001=f1(forth.distance, back.distance, tight),
            normal_consistency=mean_of_means(forth_alignment, back_alignment),
            edge_chamfer=edge_chamfer,
            edge_f1=edge_f1,
            volume_ratio=abs(mine.volume / its.volume) if solid else None,
            watertight=mine.watertight,
            truth_watertight=its.watertight,
            components=mine.components,
            truth_components=its.components,
            euler=mine.euler,
            truth_euler=its.euler,
            genus=mine.genus,
            truth_genus=its.genus,
            unit_length=cube_frame(truth).scale,
        )

    def _edges(self, made: Mesh, true: Mesh, seed: int) -> tuple[float | None, float | None]:
        mine, its = sharp_edges(made), sharp_edges(true)
        if not len(its) or not len(mine):
            return None, 0.0 if len(its) else None
        forth = distance_to_edges(sample_edges(mine, self.edge_samples, (seed, MESH_EDGE_STREAM)), its)
        back = distance_to_edges(sample_edges(its, self.edge_samples, (seed, TRUTH_EDGE_STREAM)), mine)
        return mean_of_means(forth, back), f1(forth, back, self.thresholds[0])

    def _one_way(self, source: Mesh, target: Mesh, seed: tuple[int, int]) -> tuple[Closest, Values]:
        points, faces = sample_surface(source, self.samples, seed)
        found = closest(target, points)
        return found, alignment(face_normals(source)[faces], face_normals(target)[found.face])


EXACT = Exact()

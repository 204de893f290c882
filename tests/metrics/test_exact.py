"""exact-1 against closed forms, what it is invariant to, and its edge cases; reference.py has it slow."""

import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.integrate import dblquad

sys.path.insert(0, str(Path(__file__).parent))
from shapes import BOX, CUBE, QUARTER_TURN, SPHERE, TURN, as_mesh, bent, moved, similar, square

from weingarten.metrics.exact import EXACT, Exact

SMALL = Exact(samples=20_000, edge_samples=5_000)
LENGTHS = ("chamfer", "distance_95", "hausdorff", "edge_chamfer")


def test_of_identical_meshes():
    found = EXACT.evaluate(BOX, BOX)
    assert found.hausdorff < 1e-12
    assert (found.f1_005, found.f1_001, found.volume_ratio) == (1, 1, 1)
    assert found.normal_consistency == pytest.approx(1, abs=1e-9)
    assert (found.genus, found.euler, found.components, found.watertight) == (0, 2, 1, True)
    assert (found.edge_chamfer, found.edge_f1) == (pytest.approx(0, abs=1e-12), 1)
    assert found.flags == ()


def test_of_concentric_spheres():
    """Radii r and r + δ: every distance is δ, every normal parallel, the volume's ratio (1 + δ/r)³.

    The faces of two similar polyhedra are parallel at δ ρ, ρ = cos of the angle between a face's middle and
    its corners: here 1 − ρ < 4·10⁻⁵, so that an error of δ (1 − ρ) < 10⁻⁷ remains, and a rim about each face
    where an edge or the neighbour is nearest, of less effect still.
    """
    sphere, delta = as_mesh(trimesh.creation.icosphere(6)), 0.004
    found = EXACT.evaluate(similar(sphere, 37 * (1 + delta), shift=5.0), similar(sphere, 37, shift=5.0))
    expected = delta / 2  # the unit-cube length is the diameter
    for name in ("chamfer", "distance_95", "hausdorff"):
        assert getattr(found, name) == pytest.approx(expected, abs=1e-6)
    assert (found.f1_005, found.f1_001) == (1, 0)
    assert found.normal_consistency == pytest.approx(1, abs=1e-5)
    assert found.volume_ratio == pytest.approx((1 + delta) ** 3, abs=1e-9)
    assert found.unit_length == pytest.approx(74, rel=1e-12)
    assert (found.edge_chamfer, found.edge_f1) == (None, None)


def test_of_parallel_squares():
    """At a distance h: every distance is h."""
    flat = square((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0))
    found = EXACT.evaluate(moved(flat, 0, 0, 0.008), flat)
    for name in LENGTHS:
        assert getattr(found, name) == pytest.approx(0.004, abs=1e-12)
    assert (found.f1_005, found.f1_001, found.edge_f1) == (1, 0, 1)
    assert found.normal_consistency == pytest.approx(1, abs=1e-12)


def test_of_squares_at_an_angle():
    """Of one another's normals the cosine, wherever the samples are."""
    flat = square((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    found = EXACT.evaluate(similar(flat, 1, TURN), flat)
    assert found.normal_consistency == pytest.approx(abs(TURN[2, 2]), abs=1e-12)


def shifted_box_chamfer(sides: tuple[float, float, float], d: float) -> float:
    """Mean distance of ∂A to ∂B, with A = [0, a] × [0, b] × [0, c] and B = A + (d, d, d), d small.

    Reflection about the common centre swaps A and B, so both ways have this mean. On the side x = 0 of A a
    point lies d before B's side x = d, and farther from it where y < d or z < d, for there B ends:

        √(d² + max(d − y, 0)² + max(d − z, 0)²).

    On the side x = a it lies within the slab of B, d from B's side x = a + d. With y > d and z > d it is in
    B, whose sides y = d and z = d may be nearer: min(d, y − d, z − d). Else it is outside:
    √(max(d − y, 0)² + max(d − z, 0)²). In units of d, for the pair (s, t) = (y, z) / d, both integrals are
    those of strips, where one of s, t is large, and of one corner. For x = 0 with K = ∫₀¹ √(1 + s²) ds:

        d [(b − d)(c − d) + K d (b + c − 2d) + d² ∬ √(1 + s² + t²) over the unit square].

    For x = a, a strip 0 < s < 2 has ∫ |1 − s| ds = 1, and the corner [0, 2]² has (√2 + asinh 1)/3 where both
    are below 1 (the mean distance of a unit square's points from a corner), ½ + ½ where one is, and ⅓, the
    mean of the smaller of two uniform numbers, where none is.
    """
    edge = (np.sqrt(2) + np.arcsinh(1)) / 2
    outer = dblquad(lambda s, t: np.sqrt(1 + s * s + t * t), 0, 1, 0, 1)[0]
    inner = (np.sqrt(2) + np.arcsinh(1)) / 3 + 1 + 1 / 3
    total = area = 0.0
    for b, c in ((sides[1], sides[2]), (sides[2], sides[0]), (sides[0], sides[1])):
        total += d * ((b - d) * (c - d) + edge * d * (b + c - 2 * d) + outer * d * d)
        total += d * ((b - 2 * d) * (c - 2 * d) + d * (b + c - 4 * d) + inner * d * d)
        area += 2 * b * c
    return total / area


def shifted_box_edge_chamfer(sides: tuple[float, float, float], d: float) -> float:
    """Mean distance of the edges of the same A to those of the same B.

    The parallel edge of B is d √2 away and begins d later. By reflection both ways have this mean. Of the
    four edges of A along x, that through (0, 0) has d √2 but for √(2d² + (d − x)²) on 0 < x < d; with
    ∫₀¹ √(2 + s²) ds = (√3 + 2 asinh √½)/2. Each of the other three meets, at x = d, an edge of B
    across it, at the distance √((x − d)² + d²) < d √2 on 0 < x < 2d, of integral 2 K d².
    """
    along = (np.sqrt(3) + 2 * np.arcsinh(np.sqrt(0.5))) / 2
    across = np.sqrt(2) + np.arcsinh(1)  # 2 K
    total = 0.0
    for a in sides:
        total += np.sqrt(2) * d * (a - d) + along * d * d
        total += 3 * (np.sqrt(2) * d * (a - 2 * d) + across * d * d)
    return total / (4 * sum(sides))


@pytest.mark.parametrize("shift", [1.2e-3, 2.5e-3])
def test_of_a_shifted_box(shift: float):
    """The samples' noise is that of the strips alone: below 10⁻⁶ for so small shifts and so many samples."""
    sides = (1, 0.5, 0.25)
    found = Exact(samples=1_000_000, edge_samples=400_000).evaluate(moved(BOX, shift, shift, shift), BOX)
    assert found.chamfer == pytest.approx(shifted_box_chamfer(sides, shift), abs=1e-6)
    assert found.edge_chamfer == pytest.approx(shifted_box_edge_chamfer(sides, shift), abs=1e-6)
    assert found.distance_95 == pytest.approx(shift, rel=0.02)
    assert shift <= found.hausdorff <= shift * np.sqrt(3) + 1e-12
    assert found.volume_ratio == pytest.approx(1, abs=1e-12)
    assert (found.f1_005, found.edge_f1) == (1, 1)
    assert found.f1_001 < 0.02


def test_edges_of_a_cube_a_little_larger():
    """Every edge of a cube of 1.004 is 0.002 √2 from that of the unit cube, but for its ends beyond."""
    larger = EXACT.evaluate(similar(CUBE, 1.004), CUBE)
    assert larger.edge_f1 == 1
    assert larger.edge_chamfer == pytest.approx(0.002 * np.sqrt(2), rel=2e-3)
    assert EXACT.evaluate(similar(CUBE, 1.02), CUBE).edge_f1 == 0


def test_edges_where_there_are_none():
    spurious, missing = SMALL.evaluate(BOX, SPHERE), SMALL.evaluate(SPHERE, BOX)
    assert (spurious.edge_chamfer, spurious.edge_f1) == (None, None)
    assert (missing.edge_chamfer, missing.edge_f1) == (None, 0.0)


def compare(after: dict, before: dict) -> None:
    """Equal but for rounding; the normals only within their noise, for rounding decides which face is asked
    where the closest point is on an edge."""
    after, before = dict(after), dict(before)
    assert after.pop("normal_consistency") == pytest.approx(before.pop("normal_consistency"), abs=1e-3)
    assert after == pytest.approx(before, rel=1e-9, abs=1e-12)


def test_is_invariant_to_scale_and_place():
    truth, mesh = similar(BOX, 1, TURN), bent(similar(BOX, 1, TURN))
    before = SMALL.evaluate(mesh, truth).values()
    after = SMALL.evaluate(similar(mesh, 37, None, 1e3), similar(truth, 37, None, 1e3)).values()
    after["unit_length"] /= 37
    compare(after, before)


def test_is_invariant_to_quarter_turns():
    truth, mesh = similar(BOX, 1, TURN), bent(similar(BOX, 1, TURN))
    before = SMALL.evaluate(mesh, truth).values()
    compare(SMALL.evaluate(similar(mesh, 1, QUARTER_TURN), similar(truth, 1, QUARTER_TURN)).values(), before)


def test_other_turns_change_the_unit_alone():
    """World lengths = figures × unit_length stay, as do F1 at thresholds of the same world length, normals,
    topology and volumes."""
    truth, mesh = BOX, bent(BOX)
    before = SMALL.evaluate(mesh, truth)
    turned = similar(truth, 1, TURN)
    ratio = SMALL.evaluate(turned, turned).unit_length / before.unit_length
    assert ratio > 1.1
    scaled = Exact("exact-1 in other units", 20_000, (0.005 / ratio, 0.001 / ratio), 5_000)
    after = scaled.evaluate(similar(mesh, 1, TURN), turned).values()
    for name in (*LENGTHS, "unit_length"):
        after[name] *= ratio if name in LENGTHS else 1 / ratio
    compare(after, before.values())


def test_same_seed_same_figures():
    small = Exact(samples=2000)
    assert small.evaluate(SPHERE, BOX, 3) == small.evaluate(SPHERE, BOX, 3)
    assert small.evaluate(SPHERE, BOX, 3) != small.evaluate(SPHERE, BOX, 4)

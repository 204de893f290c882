"""Normals and light for pictures of parts: smooth faces stay smooth, sharp edges stay sharp."""

import numpy as np
from jaxtyping import Float64

from weingarten.mesh import Mesh
from weingarten.metrics.normals import face_normals
from weingarten.metrics.topology import corner_fans, edge_keys, half_edge_pairs

Directions = Float64[np.ndarray, "*any 3"]
Lights = tuple[tuple[tuple[float, float, float], float], ...]
"""Where each light is, and its power."""

CREASE = np.cos(np.radians(32.0))

# Key from the upper left behind the viewer, a weak fill from the right, a rim from above; view frame:
# x right, y up, z towards the viewer.
LIGHTS = (((-0.40, 0.50, 0.75), 0.62), ((0.85, 0.05, 0.50), 0.23), ((0.10, 0.95, -0.10), 0.14))
# Two from nearly behind the viewer, so that colours can be read on every face that is seen, also from below.
EVEN = (((-0.30, 0.35, 0.90), 0.45), ((0.30, -0.35, 0.90), 0.30))
AMBIENT = 0.34
SHEEN = 0.08
FRONT = (0.795, 0.830, 0.875)
BACK = (0.90, 0.62, 0.50)


def corner_normals(mesh: Mesh) -> Float64[np.ndarray, "f 3 3"]:
    """Unit normals for every face corner: the angle-weighted mean over the faces around the vertex.

    Only faces that the corner reaches across edges with a dihedral angle below 32° count, so an edge of a
    part stays sharp. Vertices must be shared by neighbours, as in every mesh that this package extracts.
    """
    faces, flat = mesh.faces, face_normals(mesh)
    first, second = half_edge_pairs(edge_keys(faces))
    smooth = np.einsum("pi,pi->p", flat[first // 3], flat[second // 3]) > CREASE
    fans = corner_fans(faces, first[smooth], second[smooth]).reshape(-1)
    weighted = (flat[:, None, :] * _angles(mesh)[:, :, None]).reshape(-1, 3)
    sums = np.stack([np.bincount(fans, weights=weighted[:, k]) for k in range(3)], axis=1)[fans]
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    own = np.repeat(flat, 3, axis=0)
    return np.where(length > 1e-12, sums / np.maximum(length, 1e-12), own).reshape(-1, 3, 3)


def _angles(mesh: Mesh) -> Float64[np.ndarray, "f 3"]:
    corners = mesh.corners
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    across = np.linalg.norm(np.cross(ahead, behind), axis=2)
    return np.arctan2(across, np.einsum("fki,fki->fk", ahead, behind))


def shade(normals: Directions) -> Directions:
    """Display colour, each channel 0 to about 1, of a matt surface from unit normals in the view frame.

    Brightness, and a soft sheen (n·h)⁴⁰ about the key's half vector. A normal that looks away from the viewer
    shows the inside of the surface and gets the other colour.
    """
    facing = _facing(normals)
    half = _unit(_unit(LIGHTS[0][0]) + np.array([0.0, 0.0, 1.0]))
    sheen = SHEEN * np.maximum(0.0, facing @ half) ** 40
    light = brightness(normals)
    return np.where(normals[..., 2:] < 0, BACK, FRONT) * light[..., None] + sheen[..., None]


def brightness(normals: Directions, lights: Lights = LIGHTS) -> Float64[np.ndarray, "*any"]:
    """Σ lights max(0, n·l) + ambient, n turned to the viewer, from unit normals in the view frame."""
    facing = _facing(normals)
    light = np.full(facing.shape[:-1], AMBIENT)
    for direction, power in lights:
        light += power * np.maximum(0.0, facing @ _unit(direction))
    return light


def _facing(normals: Directions) -> Directions:
    return np.where(normals[..., 2:] < 0, -normals, normals)


def _unit(vector: tuple[float, float, float] | Float64[np.ndarray, " 3"]) -> Float64[np.ndarray, " 3"]:
    array = np.asarray(vector, dtype=np.float64)
    return array / np.linalg.norm(array)

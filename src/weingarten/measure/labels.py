"""Which primitive every vertex of a mesh belongs to."""

import numpy as np
from jaxtyping import Float64, Int32
from scipy.spatial import KDTree

from weingarten.measure.growing import Region
from weingarten.measure.skin import Skin
from weingarten.measure.surface import Points, Values, directions
from weingarten.mesh import Mesh

NONE = -1
"""The label of free-form surface."""

NEAREST = 8
"""Points of the cloud beside a vertex, whose primitives it may be of."""

REACH, SLACK = 4.0, 0.5
"""A vertex is of a primitive at most SLACK spacings away, of points at most REACH spacings away."""

MOST_FREE = 0.5
"""A vertex with a larger share of free points around it, none of them far away, is free itself."""

Labels = Int32[np.ndarray, " v"]


def vertex_normals(mesh: Mesh) -> Points:
    """The mean of the normals around each, weighted by area; unit length."""
    total, cross = np.zeros_like(mesh.vertices), mesh.cross
    for corner in range(3):
        np.add.at(total, mesh.faces[:, corner], cross)
    return directions(total)


def labelled(mesh: Mesh, regions: list[Region], skin: Skin) -> Labels:
    """The number of a region, or NONE, for every vertex; all in the unit frame.

    Of the regions that points nearby on the same wall are of, the one whose surface is the nearest.
    """
    owner = np.full(len(skin.points), NONE)
    for number, region in enumerate(regions):
        owner[region.members] = number
    count = min(NEAREST, len(skin.points))
    away, near = KDTree(skin.points).query(mesh.vertices, k=count, workers=-1)
    away, near = away.reshape(-1, count), near.reshape(-1, count)
    facing = np.einsum("vd,vkd->vk", vertex_normals(mesh), skin.normals[near]) > 0.0
    usable = facing & (away <= REACH * skin.spacing + 2.0 * away[:, :1])
    candidates = np.where(usable, owner[near], NONE)
    free = (usable & (candidates == NONE)).sum(axis=1) > MOST_FREE * np.maximum(usable.sum(axis=1), 1)
    labels, least = np.full(len(mesh.vertices), NONE, dtype=np.int32), np.full(len(mesh.vertices), np.inf)
    for number, region in enumerate(regions):
        index = np.flatnonzero((candidates == number).any(axis=1))
        distance = np.abs(region.surface.distance(mesh.vertices[index]))
        nearer = (distance < least[index]) & (distance <= SLACK * skin.spacing)
        labels[index[nearer]], least[index[nearer]] = number, distance[nearer]
    labels[free & (least > 0.1 * skin.spacing)] = NONE
    return labels


def label_areas(mesh: Mesh, labels: Labels, count: int) -> tuple[Values, float]:
    """The area of each of `count` labels, and of NONE: a third of every face goes to each of its corners."""
    share = np.repeat(mesh.areas / 3.0, 3)
    owner = labels[mesh.faces].reshape(-1)
    areas: Float64[np.ndarray, " n"] = np.bincount(owner + 1, weights=share, minlength=count + 1)
    return areas[1:], float(areas[0])

"""Pairs of faces that pass through each other, as machine code: see `self_intersections`.

Faces are (f, 3), numbers of their vertices; corners (f, 3, 3); the boxes around them, (f, 3) each, begin at
the origin. A cell's key is (x · side + y) · side + z.
"""

import numpy as np

from weingarten.machine_code import machine_code

compiled = machine_code(fastmath=False)


@compiled
def reached(first, last, side, total):
    """Every cell that the box of a face reaches into, and the face."""
    keys, owners = np.empty(total, np.int64), np.empty(total, np.int64)
    n = 0
    for face in range(len(first)):
        for x in range(first[face, 0], last[face, 0] + 1):
            for y in range(first[face, 1], last[face, 1] + 1):
                for z in range(first[face, 2], last[face, 2] + 1):
                    keys[n], owners[n] = (x * side + y) * side + z, face
                    n += 1
    return keys, owners


@compiled
def volume(p, a, b, c):
    """[p a b c], six times the signed volume of a tetrahedron."""
    ax, ay, az = a[0] - p[0], a[1] - p[1], a[2] - p[2]
    bx, by, bz = b[0] - p[0], b[1] - p[1], b[2] - p[2]
    cx, cy, cz = c[0] - p[0], c[1] - p[1], c[2] - p[2]
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)


@compiled
def crosses(p, q, face):
    """Whether the edge pq crosses the inside of a face."""
    a, b, c = face[0], face[1], face[2]
    if volume(p, a, b, c) * volume(q, a, b, c) >= 0.0:
        return False
    first, second, third = volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)
    return (first > 0.0 and second > 0.0 and third > 0.0) or (first < 0.0 and second < 0.0 and third < 0.0)


@compiled
def common(own, other):
    """How many corners two faces have in common, and the number in `own` of the last of them."""
    count, place = 0, -1
    for i in range(3):
        for j in range(3):
            if own[i] == other[j]:
                count += 1
                place = i
    return count, place


@compiled
def passes(one, other, place):
    """Whether an edge of a face crosses another face: all three, or the one opposite to corner `place`."""
    for i in range(3):
        if (place < 0 or i == (place + 1) % 3) and crosses(one[i], one[(i + 1) % 3], other):
            return True
    return False


@compiled
def mark(corners, faces, lowest, highest, keys, owners, side, cell, found):
    """Mark the faces of all pairs that pass through each other. A pair is looked at in one cell alone."""
    start = 0
    while start < len(keys):
        end = start
        while end < len(keys) and keys[end] == keys[start]:
            end += 1
        for m in range(start, end):
            one = owners[m]
            for n in range(m + 1, end):
                other = owners[n]
                apart, key = False, 0
                for axis in range(3):
                    low = max(lowest[one, axis], lowest[other, axis])
                    apart |= low > min(highest[one, axis], highest[other, axis])
                    key = key * side + int(low / cell)
                if apart or key != keys[start] or (found[one] and found[other]):
                    continue
                count, own_place = common(faces[one], faces[other])
                if count > 1:
                    continue
                other_place = common(faces[other], faces[one])[1]
                if passes(corners[one], corners[other], own_place) or passes(
                    corners[other], corners[one], other_place
                ):
                    found[one] = found[other] = True
        start = end

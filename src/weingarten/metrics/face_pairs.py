"""Pairs of faces that pass through each other, as machine code: see `self_intersections`.

Faces are (f, 3), numbers of their vertices; corners (f, 3, 3). The boxes around them, (f, 3) each, are moved
to begin at the origin; the corners are not, which would round them. The key of a cell is
(x · side + y) · side + z.
"""

import numpy as np

from weingarten.machine_code import machine_code

compiled = machine_code(fastmath=False)

ROUNDING = 8e-16
"""How far a volume can be wrong, as a share of the sum of its absolute products: 7 · 2⁻⁵³ and a little
(Shewchuk, "Adaptive precision floating-point arithmetic", 1997, the first bound of orient3d)."""


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
    """[p a b c], six times the signed volume of a tetrahedron; zero where rounding may have made its sign."""
    ax, ay, az = a[0] - p[0], a[1] - p[1], a[2] - p[2]
    bx, by, bz = b[0] - p[0], b[1] - p[1], b[2] - p[2]
    cx, cy, cz = c[0] - p[0], c[1] - p[1], c[2] - p[2]
    found = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    size = (
        abs(ax) * (abs(by * cz) + abs(bz * cy))
        + abs(ay) * (abs(bz * cx) + abs(bx * cz))
        + abs(az) * (abs(bx * cy) + abs(by * cx))
    )
    return found if abs(found) > ROUNDING * size else 0.0


@compiled
def corner(corners, face, place):
    """Where a corner is: three numbers, as views of the array take time to make."""
    return corners[face, place, 0], corners[face, place, 1], corners[face, place, 2]


@compiled
def crosses(p, q, a, b, c):
    """Whether the edge pq crosses the inside of the face abc."""
    if volume(p, a, b, c) * volume(q, a, b, c) >= 0.0:
        return False
    first, second, third = volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)
    return (first > 0.0 and second > 0.0 and third > 0.0) or (first < 0.0 and second < 0.0 and third < 0.0)


@compiled
def common(faces, one, other):
    """How many corners two faces have in common, and the places in both of the last of them."""
    count, place, its = 0, -1, -1
    for i in range(3):
        for j in range(3):
            if faces[one, i] == faces[other, j]:
                count += 1
                place, its = i, j
    return count, place, its


@compiled
def passes(corners, one, other, place):
    """Whether an edge of a face crosses another face: all three, or the one opposite to corner `place`."""
    a, b, c = corner(corners, other, 0), corner(corners, other, 1), corner(corners, other, 2)
    for i in range(3):
        asked = place < 0 or i == (place + 1) % 3
        if asked and crosses(corner(corners, one, i), corner(corners, one, (i + 1) % 3), a, b, c):
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
                key = 0
                for axis in range(3):
                    low = max(lowest[one, axis], lowest[other, axis])
                    if low > min(highest[one, axis], highest[other, axis]):
                        key = -1
                        break
                    key = key * side + int(low / cell)
                if key != keys[start] or (found[one] and found[other]):
                    continue
                count, place, its = common(faces, one, other)
                if count > 1:
                    continue
                if passes(corners, one, other, place) or passes(corners, other, one, its):
                    found[one] = found[other] = True
        start = end

"""Where the rays of a view meet a plane, a disc or a cylinder, and the frame of the surface there.

A frame is a row of numbers: 0 whether a surface is met, 1-3 the place, 4-6 the normal, 7-9 the tangent,
10 the sign of bitangent = sign × normal × tangent, 11-12 the texture coordinates (u right, v up, 0..1),
13-15 the unit vector towards the eye, 16 the depth along the line of sight.
"""

import math

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

WIDTH = 17
PLANE, DISC, CYLINDER = 0, 1, 2


@njit(cache=True)
def _meet_flat(kind, width, height, hole, radial, ox, oy, oz, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Meet z = 0 within a rectangle or a ring; return distance (0: none), side, tangent x, y, texture."""
    t = -oz / dz if dz != 0.0 else 0.0
    x, y = ox + t * dx, oy + t * dy
    u, v = 0.5 + x / width, 0.5 + y / height
    if t <= 0.0 or u < 0.0 or u > 1.0 or v < 0.0 or v > 1.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    tx, ty = 1.0, 0.0
    if kind == DISC:
        radius = math.sqrt(x * x + y * y)
        if radius > 0.5 * width or radius < hole:
            return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        if radial > 0.0 and radius > 0.0:
            tx, ty = x / radius, y / radius
    return t, 1.0 if dz < 0.0 else -1.0, tx, ty, u, v


@njit(cache=True)
def _meet_cylinder(radius, height, sweep, ox, oy, oz, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Meet the nearer wall within the sweep; return distance (0: none), side, normal x, z, texture."""
    a, b = dx * dx + dz * dz, ox * dx + oz * dz
    root = b * b - a * (ox * ox + oz * oz - radius * radius)
    if a > 0.0 and root >= 0.0:
        root = math.sqrt(root)
        for side in (-1.0, 1.0):
            t = (-b + side * root) / a
            x, y, z = ox + t * dx, oy + t * dy, oz + t * dz
            u, v = 0.5 + math.atan2(x, z) / sweep, 0.5 + y / height
            if t > 0.0 and 0.0 <= u <= 1.0 and 0.0 <= v <= 1.0:
                return t, 1.0 if x * dx + z * dz < 0.0 else -1.0, x / radius, z / radius, u, v
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@njit(cache=True)
def cast_row(kind, numbers, pose, rays, y, columns, found, where):  # type: ignore[no-untyped-def]
    """Fill found (17, columns) with the frames that a row of rays meets and where (columns,); count them.

    Pose (4, 3) is three axes of the shape in the world and its place. Rays (6, 3) are origin, direction, what
    x and y add to the origin, what they add to the direction; -1..1 are the view's borders.
    """
    n0, n1, n2, n3 = numbers[0], numbers[1], numbers[2], numbers[3]
    o, d = np.empty(3), np.empty(3)
    start, slope = np.empty(6), np.empty(6)
    for k in range(3):
        o[k], d[k] = rays[0, k] + y * rays[3, k], rays[1, k] + y * rays[5, k]
    # The row's rays in the shape's own coordinates: start + x · slope, places first, directions after.
    for m in range(3):
        start[m] = start[3 + m] = slope[m] = slope[3 + m] = 0.0
        for k in range(3):
            start[m] += pose[m, k] * (o[k] - pose[3, k])
            start[3 + m] += pose[m, k] * d[k]
            slope[m] += pose[m, k] * rays[2, k]
            slope[3 + m] += pose[m, k] * rays[4, k]
    s0, s1, s2, s3, s4, s5 = start[0], start[1], start[2], start[3], start[4], start[5]
    g0, g1, g2, g3, g4, g5 = slope[0], slope[1], slope[2], slope[3], slope[4], slope[5]
    count = 0
    for j in range(columns):
        x = (2.0 * j + 1.0) / columns - 1.0
        px, py, pz = s0 + x * g0, s1 + x * g1, s2 + x * g2
        dx, dy, dz = s3 + x * g3, s4 + x * g4, s5 + x * g5
        nx = ty = 0.0
        if kind == CYLINDER:
            t, front, nx, nz, u, v = _meet_cylinder(n0, n1, n2, px, py, pz, dx, dy, dz)
            tx, tz = nz, -nx
        else:
            t, front, tx, ty, u, v = _meet_flat(kind, n0, n1, n2, n3, px, py, pz, dx, dy, dz)
            nz, tz = 1.0, 0.0
        if t <= 0.0:
            continue
        where[count] = j
        found[0, count], found[10, count], found[11, count], found[12, count] = 1.0, front, u, v
        found[16, count] = t
        away = -1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
        for k in range(3):
            along = d[k] + x * rays[4, k]
            found[1 + k, count] = o[k] + x * rays[2, k] + t * along
            found[4 + k, count] = front * (pose[0, k] * nx + pose[2, k] * nz)
            found[7 + k, count] = pose[0, k] * tx + pose[1, k] * ty + pose[2, k] * tz
            found[13 + k, count] = away * along
        count += 1
    return count


@njit(cache=True, parallel=True)
def cast(
    kind: int,
    numbers: NDArray[np.float64],
    pose: NDArray[np.float64],
    rays: NDArray[np.float64],
    size: NDArray[np.int64],
    frames: NDArray[np.float32],
) -> None:
    """Fill zeroed frames (rows, columns, 17) for the rows from `size[2]` on of a view of size[:2] samples."""
    rows, columns, first = size[0], size[1], size[2]
    for i in prange(frames.shape[0]):
        found, where = np.empty((WIDTH, columns), np.float32), np.empty(columns, np.int64)
        y = 1.0 - (2.0 * (i + first) + 1.0) / rows
        count = cast_row(kind, numbers, pose, rays, y, columns, found, where)
        for m in range(count):
            for k in range(WIDTH):
                frames[i, where[m], k] = found[k, m]

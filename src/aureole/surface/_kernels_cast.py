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
def _meet(kind, numbers, o, d, local):  # type: ignore[no-untyped-def]
    """Fill a local hit: 0 distance, 1-3 normal, 4-6 tangent, 7 sign, 8-9 texture; return whether there is one."""
    if kind == CYLINDER:
        return _meet_cylinder(numbers, o, d, local)
    if d[2] == 0.0:
        return False
    t = -o[2] / d[2]
    x, y = o[0] + t * d[0], o[1] + t * d[1]
    tx, ty = 1.0, 0.0
    u, v = 0.5 + x / numbers[0], 0.5 + y / numbers[1]
    if t <= 0.0 or u < 0.0 or u > 1.0 or v < 0.0 or v > 1.0:
        return False
    if kind == DISC:
        radius = math.sqrt(x * x + y * y)
        if radius > 0.5 * numbers[0] or radius < numbers[2]:
            return False
        if numbers[3] > 0.0 and radius > 0.0:
            tx, ty = x / radius, y / radius
    front = 1.0 if d[2] < 0.0 else -1.0
    local[0], local[1], local[2], local[3] = t, 0.0, 0.0, front
    local[4], local[5], local[6] = tx, ty, 0.0
    local[7], local[8], local[9] = front, u, v
    return True


@njit(cache=True)
def _meet_cylinder(numbers, o, d, local):  # type: ignore[no-untyped-def]
    """Meet the nearer wall within the sweep: axis y, middle of the sweep at +z, tangent around the axis."""
    radius, height, sweep = numbers[0], numbers[1], numbers[2]
    a = d[0] * d[0] + d[2] * d[2]
    b = o[0] * d[0] + o[2] * d[2]
    root = b * b - a * (o[0] * o[0] + o[2] * o[2] - radius * radius)
    if a == 0.0 or root < 0.0:
        return False
    root = math.sqrt(root)
    for side in (-1.0, 1.0):
        t = (-b + side * root) / a
        x, y, z = o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]
        u, v = 0.5 + math.atan2(x, z) / sweep, 0.5 + y / height
        if t > 0.0 and 0.0 <= u <= 1.0 and 0.0 <= v <= 1.0:
            nx, nz = x / radius, z / radius
            front = 1.0 if nx * d[0] + nz * d[2] < 0.0 else -1.0
            local[0], local[1], local[2], local[3] = t, front * nx, 0.0, front * nz
            local[4], local[5], local[6] = nz, 0.0, -nx
            local[7], local[8], local[9] = front, u, v
            return True
    return False


@njit(cache=True, parallel=True)
def cast(
    kind: int,
    numbers: NDArray[np.float64],
    pose: NDArray[np.float64],
    view: NDArray[np.float64],
    perspective: bool,
    size: NDArray[np.int64],
    frames: NDArray[np.float32],
) -> None:
    """Fill frames (rows, columns, 17) for the rows of samples from `size[2]` on.

    Pose (4, 3) is three axes of the shape in the world and its place; view (4, 3) is eye, right, up,
    forward; size is the view's sampled rows and columns, and the first row asked for.
    """
    rows, columns, first = size
    for i in prange(frames.shape[0]):
        d, o, direction, origin = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
        local = np.empty(10)
        y = 1.0 - (2.0 * (i + first) + 1.0) / rows
        for j in range(columns):
            x = (2.0 * j + 1.0) / columns - 1.0
            for k in range(3):
                aside = x * view[1, k] + y * view[2, k]
                direction[k] = view[3, k] + aside if perspective else view[3, k]
                origin[k] = view[0, k] if perspective else view[0, k] + aside
            for k in range(3):
                d[k], o[k] = 0.0, 0.0
                for m in range(3):
                    d[k] += pose[k, m] * direction[m]
                    o[k] += pose[k, m] * (origin[m] - pose[3, m])
            frame = frames[i, j]
            frame[0] = 0.0
            if not _meet(kind, numbers, o, d, local):
                continue
            frame[0], frame[10], frame[11], frame[12], frame[16] = 1.0, local[7], local[8], local[9], local[0]
            away = 1.0 / math.sqrt(direction[0] ** 2 + direction[1] ** 2 + direction[2] ** 2)
            for k in range(3):
                frame[1 + k] = origin[k] + local[0] * direction[k]
                frame[4 + k] = pose[0, k] * local[1] + pose[1, k] * local[2] + pose[2, k] * local[3]
                frame[7 + k] = pose[0, k] * local[4] + pose[1, k] * local[5] + pose[2, k] * local[6]
                frame[13 + k] = -direction[k] * away

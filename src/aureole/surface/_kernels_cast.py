"""Where the rays of a view meet a plane, a disc or a cylinder, and the frame of the surface there.

Numbers of 64 samples lie together in a block, row after row: a row of a block is one of the constants below,
which are where it starts. A frame has 17 rows: whether a surface is met; the place; the normal; the tangent;
the sign of bitangent = sign × normal × tangent; the texture coordinates (u right, v up, 0..1); the unit
vector towards the eye; the depth along the line of sight. A hit has 6: the place in the shape's coordinates,
the view's x and y, the depth.
"""

import math

import numpy as np
from numba import njit

LANES, WIDTH, HIT_WIDTH = 64, 17, 6
MET, PX, PY, PZ, NX, NY, NZ, TX, TY, TZ, SIGN, RIGHT, UP, OX, OY, OZ, DEPTH = range(0, LANES * WIDTH, LANES)
HX, HY, HZ, VIEW_X, VIEW_Y, HIT_DEPTH = range(0, LANES * HIT_WIDTH, LANES)
PLANE, DISC, CYLINDER = 0, 1, 2
ONE, ZERO = np.float32(1.0), np.float32(0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def _meet_flat(kind, width, height, hole, ox, oy, oz, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Return the distance at which z = 0 is met within a rectangle or a ring; 0 is nowhere."""
    t = -oz / dz if dz != 0.0 else 0.0
    x, y = ox + t * dx, oy + t * dy
    square = x * x + y * y
    if t <= 0.0 or 2.0 * abs(x) > width or 2.0 * abs(y) > height:
        return 0.0
    if kind == DISC and (4.0 * square > width * width or square < hole * hole):
        return 0.0
    return t


@njit(cache=True, nogil=True, error_model="numpy")
def _meet_cylinder(radius, height, sweep, ox, oy, oz, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Return the distance at which the nearer wall is met within the sweep; 0 is nowhere."""
    a, b = dx * dx + dz * dz, ox * dx + oz * dz
    root = b * b - a * (ox * ox + oz * oz - radius * radius)
    if a > 0.0 and root >= 0.0:
        root = math.sqrt(root)
        for side in (-1.0, 1.0):
            t = (-b + side * root) / a
            x, y, z = ox + t * dx, oy + t * dy, oz + t * dz
            if t > 0.0 and 2.0 * abs(y) <= height and 2.0 * abs(math.atan2(x, z)) <= sweep:
                return t
    return 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def cast(kind, numbers, pose, rays, bounds, hits, where):  # type: ignore[no-untyped-def]
    """Fill hits (B, 6 · 64) of the rays that meet a shape, and where (64 B,) with their pixels; count them.

    Pose (4, 3) is three axes of the shape in the world and its place. Rays (6, 3) are origin, direction, what
    x and y add to the origin, what they add to the direction; -1..1 are the view's borders. Bounds are rows
    and columns of samples, the first row to cast and the one after the last, and samples along a side of a
    pixel; pixels are counted from the first row.
    """
    rows, columns, first, last, side = bounds
    n0, n1, n2 = numbers[0], numbers[1], numbers[2]
    start, slope = np.empty(6), np.empty(6)
    count = 0
    for i in range(first, last):
        y = 1.0 - (2.0 * i + 1.0) / rows
        # The row's rays in the shape's own coordinates: start + x · slope, places first, directions after.
        for m in range(3):
            start[m] = start[3 + m] = slope[m] = slope[3 + m] = 0.0
            for k in range(3):
                start[m] += pose[m, k] * (rays[0, k] + y * rays[3, k] - pose[3, k])
                start[3 + m] += pose[m, k] * (rays[1, k] + y * rays[5, k])
                slope[m] += pose[m, k] * rays[2, k]
                slope[3 + m] += pose[m, k] * rays[4, k]
        s0, s1, s2, s3, s4, s5 = start[0], start[1], start[2], start[3], start[4], start[5]
        g0, g1, g2, g3, g4, g5 = slope[0], slope[1], slope[2], slope[3], slope[4], slope[5]
        pixel, part, step = (i - first) // side * (columns // side), 0, 2.0 / columns
        for j in range(columns):
            x = step * j + (0.5 * step - 1.0)
            ox, oy, oz = s0 + x * g0, s1 + x * g1, s2 + x * g2
            dx, dy, dz = s3 + x * g3, s4 + x * g4, s5 + x * g5
            if kind == CYLINDER:
                t = _meet_cylinder(n0, n1, n2, ox, oy, oz, dx, dy, dz)
            else:
                t = _meet_flat(kind, n0, n1, n2, ox, oy, oz, dx, dy, dz)
            if t > 0.0:
                block, lane = count // LANES, count % LANES
                hits[block, HX + lane] = ox + t * dx
                hits[block, HY + lane] = oy + t * dy
                hits[block, HZ + lane] = oz + t * dz
                hits[block, VIEW_X + lane] = x
                hits[block, VIEW_Y + lane] = y
                hits[block, HIT_DEPTH + lane] = t
                where[count] = pixel
                count += 1
            part += 1
            if part == side:
                part, pixel = 0, pixel + 1
    return count


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _lay_flat(kind, numbers, hits, frames, b):  # type: ignore[no-untyped-def]
    """Fill a block's normals, tangents and texture coordinates in the shape's coordinates, where z = 0."""
    radial = ONE if kind == DISC and numbers[3] > ZERO else ZERO
    across, down = ONE / numbers[0], ONE / numbers[1]
    for j in range(LANES):
        x, y = hits[b, HX + j], hits[b, HY + j]
        square = x * x + y * y
        # Along x where the tangent is not radial, and in the disc's middle.
        turned = radial if square > ZERO else ZERO
        scale = turned / math.sqrt(square + (ONE - turned))
        frames[b, NX + j] = frames[b, NY + j] = ZERO
        frames[b, NZ + j] = ONE
        frames[b, TX + j], frames[b, TY + j] = x * scale + (ONE - turned), y * scale
        frames[b, TZ + j] = ZERO
        frames[b, RIGHT + j] = np.float32(0.5) + x * across
        frames[b, UP + j] = np.float32(0.5) + y * down


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _lay_round(numbers, hits, frames, b):  # type: ignore[no-untyped-def]
    """Fill a block's normals, tangents and texture coordinates in the coordinates of a cylinder."""
    scale = ONE / numbers[0]
    for j in range(LANES):
        x, z = hits[b, HX + j], hits[b, HZ + j]
        frames[b, NX + j], frames[b, NY + j], frames[b, NZ + j] = x * scale, ZERO, z * scale
        frames[b, TX + j], frames[b, TY + j], frames[b, TZ + j] = z * scale, ZERO, -x * scale
        frames[b, RIGHT + j] = np.float32(0.5) + math.atan2(x, z) / numbers[2]
        frames[b, UP + j] = np.float32(0.5) + hits[b, HY + j] / numbers[1]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _turn(pose, frames, b, row):  # type: ignore[no-untyped-def]
    """Turn a block's three rows from the shape's coordinates into the world."""
    a0, a1, a2, b0, b1, b2 = pose[0, 0], pose[0, 1], pose[0, 2], pose[1, 0], pose[1, 1], pose[1, 2]
    c0, c1, c2 = pose[2, 0], pose[2, 1], pose[2, 2]
    for j in range(LANES):
        x, y, z = frames[b, row + j], frames[b, row + LANES + j], frames[b, row + 2 * LANES + j]
        frames[b, row + j] = a0 * x + b0 * y + c0 * z
        frames[b, row + LANES + j] = a1 * x + b1 * y + c1 * z
        frames[b, row + 2 * LANES + j] = a2 * x + b2 * y + c2 * z


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _look(pose, rays, hits, frames, b):  # type: ignore[no-untyped-def]
    """Move a block's places to the world, fill the directions to the eye and turn the normals to it."""
    p0, p1, p2, d0, d1, d2 = pose[3, 0], pose[3, 1], pose[3, 2], rays[1, 0], rays[1, 1], rays[1, 2]
    r0, r1, r2, u0, u1, u2 = rays[4, 0], rays[4, 1], rays[4, 2], rays[5, 0], rays[5, 1], rays[5, 2]
    for j in range(LANES):
        x, y = hits[b, VIEW_X + j], hits[b, VIEW_Y + j]
        ox, oy, oz = -(d0 + x * r0 + y * u0), -(d1 + x * r1 + y * u1), -(d2 + x * r2 + y * u2)
        scale = ONE / math.sqrt(ox * ox + oy * oy + oz * oz)
        facing = frames[b, NX + j] * ox + frames[b, NY + j] * oy + frames[b, NZ + j] * oz
        front = ONE if facing >= ZERO else -ONE
        frames[b, MET + j], frames[b, SIGN + j], frames[b, DEPTH + j] = ONE, front, hits[b, HIT_DEPTH + j]
        frames[b, PX + j], frames[b, PY + j] = frames[b, PX + j] + p0, frames[b, PY + j] + p1
        frames[b, PZ + j] += p2
        frames[b, NX + j], frames[b, NY + j] = frames[b, NX + j] * front, frames[b, NY + j] * front
        frames[b, NZ + j] *= front
        frames[b, OX + j], frames[b, OY + j], frames[b, OZ + j] = ox * scale, oy * scale, oz * scale


@njit(cache=True, nogil=True, error_model="numpy")
def lay_frames(kind, numbers, pose, rays, hits, blocks, frames):  # type: ignore[no-untyped-def]
    """Fill blocks of frames (B, 17 · 64) at hits."""
    for b in range(blocks):
        if kind == CYLINDER:
            _lay_round(numbers, hits, frames, b)
        else:
            _lay_flat(kind, numbers, hits, frames, b)
        for j in range(3 * LANES):
            frames[b, PX + j] = hits[b, HX + j]
        for row in range(PX, SIGN, 3 * LANES):
            _turn(pose, frames, b, row)
        _look(pose, rays, hits, frames, b)

"""Barycentric coordinates of a point in a quad, as plain functions of numbers for rasters to call.

Each takes the point and the corners around the quad, and returns the four corners' weights and whether all of
them lie in 0..1; a quad without area gives four zeros. Numbers stay in the precision that they come in.
"""

import math
from typing import Any, TypeAlias

import numba
import numpy as np
from numpy.typing import NDArray

Weights: TypeAlias = tuple[float, float, float, float, bool]
Numbers: TypeAlias = NDArray[np.float64]

# Constants of single precision do not widen the numbers that they meet.
ZERO: Any = np.float32(0)
HALF: Any = np.float32(0.5)
ONE: Any = np.float32(1)
TWO: Any = np.float32(2)
FOUR: Any = np.float32(4)


@numba.njit(cache=True)
def cross(ax: float, ay: float, bx: float, by: float) -> float:
    """Return a × b, twice the signed area of the triangle that two vectors span."""
    return ax * by - ay * bx


@numba.njit(cache=True)
def all_within(a: float, b: float, c: float, d: float) -> bool:
    """Return whether no weight is below 0; as they add up to 1, none is then above it."""
    lowest: float = min(min(a, b), min(c, d))
    return lowest >= 0


@numba.njit(cache=True)
def triangle(
    px: float,
    py: float,
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    x2: float,
    y2: float,
    x3: float,
    y3: float,
) -> Weights:
    """Return weights in the half of the quad, cut from corner 0 to 2, on the point's side (Eq. 3-4)."""
    dx, dy, qx, qy = x2 - x0, y2 - y0, px - x0, py - y0
    first = cross(dx, dy, qx, qy) * cross(dx, dy, x1 - x0, y1 - y0) >= ZERO
    ex, ey = (x1 - x0, y1 - y0) if first else (x3 - x0, y3 - y0)
    area = cross(ex, ey, dx, dy)
    if area == ZERO:
        return ZERO, ZERO, ZERO, ZERO, False
    off, far = cross(qx, qy, dx, dy) / area, cross(ex, ey, qx, qy) / area
    near = ONE - off - far
    one, three = (off, ZERO) if first else (ZERO, off)
    return near, one, far, three, all_within(near, off, far, ZERO)


@numba.njit(cache=True)
def homogeneous(
    px: float,
    py: float,
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    x2: float,
    y2: float,
    x3: float,
    y3: float,
) -> Weights:
    """Return the same weights from the cross product of the homogeneous vectors x, y and 1 (Eq. 5-6)."""
    x0, y0, x1, y1 = x0 - px, y0 - py, x1 - px, y1 - py
    x2, y2, x3, y3 = x2 - px, y2 - py, x3 - px, y3 - py
    # With the point as origin a component of the product is the area of the point and two corners.
    diagonal = cross(x2, y2, x0, y0)
    first = diagonal * (diagonal + cross(x0, y0, x1, y1) + cross(x1, y1, x2, y2)) >= ZERO
    x1, y1 = (x1, y1) if first else (x3, y3)
    near, far = cross(x1, y1, x2, y2), cross(x0, y0, x1, y1)
    whole = near + diagonal + far
    if whole == ZERO:
        return ZERO, ZERO, ZERO, ZERO, False
    near, off, far = near / whole, diagonal / whole, far / whole
    one, three = (off, ZERO) if first else (ZERO, off)
    return near, one, far, three, all_within(near, off, far, ZERO)


@numba.njit(cache=True)
def half_tangent(ax: float, ay: float, a: float, bx: float, by: float, b: float) -> float:
    """Return tan(α/2) of the signed angle between vectors of lengths a and b, without cancelling."""
    along, across = ax * bx + ay * by, ax * by - ay * bx
    return across / (a * b + along) if along > ZERO else (a * b - along) / across


@numba.njit(cache=True)
def mean_value(
    px: float,
    py: float,
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    x2: float,
    y2: float,
    x3: float,
    y3: float,
) -> Weights:
    """Return mean value coordinates (Eq. 7), which concave and self-crossing quads have, too."""
    x0, y0, x1, y1 = x0 - px, y0 - py, x1 - px, y1 - py
    x2, y2, x3, y3 = x2 - px, y2 - py, x3 - px, y3 - py
    r0, r1 = math.sqrt(x0 * x0 + y0 * y0), math.sqrt(x1 * x1 + y1 * y1)
    r2, r3 = math.sqrt(x2 * x2 + y2 * y2), math.sqrt(x3 * x3 + y3 * y3)
    # On an edge, its ends included, weights run straight from corner to corner.
    if cross(x0, y0, x1, y1) == ZERO and x0 * x1 + y0 * y1 <= ZERO and r0 + r1 > ZERO:
        return r1 / (r0 + r1), r0 / (r0 + r1), ZERO, ZERO, True
    if cross(x1, y1, x2, y2) == ZERO and x1 * x2 + y1 * y2 <= ZERO and r1 + r2 > ZERO:
        return ZERO, r2 / (r1 + r2), r1 / (r1 + r2), ZERO, True
    if cross(x2, y2, x3, y3) == ZERO and x2 * x3 + y2 * y3 <= ZERO and r2 + r3 > ZERO:
        return ZERO, ZERO, r3 / (r2 + r3), r2 / (r2 + r3), True
    if cross(x3, y3, x0, y0) == ZERO and x3 * x0 + y3 * y0 <= ZERO and r3 + r0 > ZERO:
        return r3 / (r3 + r0), ZERO, ZERO, r0 / (r3 + r0), True
    if min(min(r0, r1), min(r2, r3)) == ZERO:
        return ZERO, ZERO, ZERO, ZERO, False
    t0, t1 = half_tangent(x0, y0, r0, x1, y1, r1), half_tangent(x1, y1, r1, x2, y2, r2)
    t2, t3 = half_tangent(x2, y2, r2, x3, y3, r3), half_tangent(x3, y3, r3, x0, y0, r0)
    a, b, c, d = (t3 + t0) / r0, (t0 + t1) / r1, (t1 + t2) / r2, (t2 + t3) / r3
    return shares(a, b, c, d)


@numba.njit(cache=True)
def shares(a: float, b: float, c: float, d: float) -> Weights:
    """Return four numbers as parts of their sum (Eq. 8)."""
    whole = a + b + c + d
    if whole == ZERO:
        return ZERO, ZERO, ZERO, ZERO, False
    a, b, c, d = a / whole, b / whole, c / whole, d / whole
    return a, b, c, d, all_within(a, b, c, d)


@numba.njit(cache=True)
def wachspress_of_areas(
    a0: float, a1: float, a2: float, a3: float, c0: float, c1: float, c2: float, c3: float
) -> Weights:
    """Return Wachspress' weights (Eq. 8-9) of the areas of point and edge k to k + 1, and of the corners.

    The areas are linear in the point, so that a raster can step them along a row.
    """
    return shares(c0 * a1 * a2, c1 * a2 * a3, c2 * a3 * a0, c3 * a0 * a1)


@numba.njit(cache=True)
def loop_derose_of_areas(a0: float, a1: float, a2: float, a3: float) -> Weights:
    """Return Loop and DeRose's weights (Eq. 8, 10) of the areas of point and edge k to k + 1."""
    return shares(a1 * a2, a2 * a3, a3 * a0, a0 * a1)


@numba.njit(cache=True)
def wachspress(
    px: float,
    py: float,
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    x2: float,
    y2: float,
    x3: float,
    y3: float,
) -> Weights:
    """Return Wachspress coordinates (Eq. 8-9, with v_i+1 for the printed v_j+1); for convex quads."""
    return wachspress_of_areas(
        cross(x0 - px, y0 - py, x1 - px, y1 - py),
        cross(x1 - px, y1 - py, x2 - px, y2 - py),
        cross(x2 - px, y2 - py, x3 - px, y3 - py),
        cross(x3 - px, y3 - py, x0 - px, y0 - py),
        cross(x0 - x3, y0 - y3, x1 - x0, y1 - y0),
        cross(x1 - x0, y1 - y0, x2 - x1, y2 - y1),
        cross(x2 - x1, y2 - y1, x3 - x2, y3 - y2),
        cross(x3 - x2, y3 - y2, x0 - x3, y0 - y3),
    )


@numba.njit(cache=True)
def loop_derose(
    px: float,
    py: float,
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    x2: float,
    y2: float,
    x3: float,
    y3: float,
) -> Weights:
    """Return Loop and DeRose's coordinates as printed (Eq. 8, 10): true to lines only on parallelograms."""
    return loop_derose_of_areas(
        cross(x0 - px, y0 - py, x1 - px, y1 - py),
        cross(x1 - px, y1 - py, x2 - px, y2 - py),
        cross(x2 - px, y2 - py, x3 - px, y3 - py),
        cross(x3 - px, y3 - py, x0 - px, y0 - py),
    )


@numba.njit(cache=True)
def bilinear(
    px: float,
    py: float,
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    x2: float,
    y2: float,
    x3: float,
    y3: float,
) -> Weights:
    """Return the weights with which a grid's cell maps onto the point: a + u e + v f + u v g = 0."""
    ax, ay, ex, ey, fx, fy = x0 - px, y0 - py, x1 - x0, y1 - y0, x3 - x0, y3 - y0
    gx, gy = x2 - x1 - fx, y2 - y1 - fy
    # (a + v f) × (e + v g) = 0, of whose two roots one leads into a convex quad.
    square, half, rest = (
        cross(fx, fy, gx, gy),
        cross(ax, ay, gx, gy) + cross(fx, fy, ex, ey),
        cross(ax, ay, ex, ey),
    )
    inner = half * half - FOUR * square * rest
    if inner < ZERO:
        return ZERO, ZERO, ZERO, ZERO, False
    root = -HALF * (half + math.copysign(math.sqrt(inner), half))
    if root == ZERO:
        return ZERO, ZERO, ZERO, ZERO, False
    near, other = rest / root, root / square if square != ZERO else TWO
    if abs(other - HALF) < abs(near - HALF):
        near, other = other, near
    u = across(ax, ay, ex, ey, fx, fy, gx, gy, near)
    if not (ZERO <= u <= ONE and ZERO <= near <= ONE):
        again = across(ax, ay, ex, ey, fx, fy, gx, gy, other)
        if ZERO <= again <= ONE and ZERO <= other <= ONE:
            u, near = again, other
    inside = ZERO <= u <= ONE and ZERO <= near <= ONE
    return (ONE - u) * (ONE - near), u * (ONE - near), u * near, (ONE - u) * near, inside


@numba.njit(cache=True)
def across(
    ax: float, ay: float, ex: float, ey: float, fx: float, fy: float, gx: float, gy: float, v: float
) -> float:
    """Return u of a + v f + u (e + v g) = 0, from the longer side of the vector behind it."""
    sx, sy = ex + v * gx, ey + v * gy
    if abs(sx) > abs(sy):
        return -(ax + v * fx) / sx
    return -(ay + v * fy) / sy if sy != ZERO else -ONE


@numba.njit(cache=True)
def coordinates(quads: Numbers, points: Numbers, method: int, out: Numbers) -> None:
    """Fill the weights of points, each in its quad, by the method of a number.

    Parameters
    ----------
    quads : ndarray, shape (N, 4, 2)
        Corners around each quad.
    points : ndarray, shape (N, 2)
        One for each quad.
    method : int
        0 triangle, 1 homogeneous, 2 mean value, 3 Wachspress, 4 Loop and DeRose, 5 bilinear.
    out : ndarray, shape (N, 4)
        Filled.
    """
    for k in range(len(quads)):
        q, px, py = quads[k], points[k, 0], points[k, 1]
        x0, y0, x1, y1 = q[0, 0], q[0, 1], q[1, 0], q[1, 1]
        x2, y2, x3, y3 = q[2, 0], q[2, 1], q[3, 0], q[3, 1]
        if method == 0:
            found = triangle(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
        elif method == 1:
            found = homogeneous(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
        elif method == 2:
            found = mean_value(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
        elif method == 3:
            found = wachspress(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
        elif method == 4:
            found = loop_derose(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
        else:
            found = bilinear(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = found[0], found[1], found[2], found[3]

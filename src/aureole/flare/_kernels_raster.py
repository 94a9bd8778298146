"""Compiled loops that lay one primitive into a window of the picture, by the area it covers.

A window is kept in blocks: [block row, block column, 64], where the 64 pixels of an 8×8 block are four 4×4
parts (top left, top right, bottom left, bottom right), each row by row: the inner loops' lengths are fixed.

How much of a pixel lies behind an edge is told by its ramp 1/2 + E, clamped to 0..1, where E falls by 1 over
the pixel's width across the edge. Ramps of neighbours add up to 1, and those of a strip add up to its area.
"""

import math
from typing import Any, TypeAlias

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
# A number of single precision, and several.
Real: TypeAlias = Any
Three: TypeAlias = tuple[Real, Real, Real]
Four: TypeAlias = tuple[Real, Real, Real, Real]
Five: TypeAlias = tuple[Real, Real, Real, Real, Real]

# What becomes of a primitive.
SKIPPED, FLAT, EDGED, CURVED, ROUGH = 0, 1, 2, 3, 4
# Numbers in a row of the table: edges' slopes in x and y and values, brightness and its slopes, orientation.
ROW = 16
# Most samples along a rough quad's side.
MOST_SAMPLES = 64

FAST = {"nnan", "ninf", "nsz", "contract"}
ZERO, HALF, ONE, TWO, FOUR = np.float32(0), np.float32(0.5), np.float32(1), np.float32(2), np.float32(4)
# How far the ramps of a part and of a block reach beyond its centre.
PART_MIDDLE, PART_REACH, BLOCK_MIDDLE, BLOCK_REACH = (
    np.float32(1.5),
    np.float32(2),
    np.float32(3.5),
    np.float32(4),
)
TINY, NEAR = np.float32(1e-20), np.float32(1e-6)


@numba.njit(cache=True, nogil=True, fastmath=FAST)
def ramp(distance: Real) -> Real:
    """Return the part of a pixel that lies behind an edge."""
    return min(max(distance + HALF, ZERO), ONE)


@numba.njit(cache=True, nogil=True, fastmath=FAST)
def strip(one: Real, other: Real) -> Real:
    """Return the part of a pixel that lies between two edges."""
    return max(ramp(one) + ramp(other) - ONE, ZERO)


@numba.njit(cache=True, nogil=True, fastmath=FAST)
def covered(e: Four, a: Four, b: Four, s: Real, t: Real) -> Real:
    """Return the part of a pixel between two pairs of edges, of their values at a place and their slopes."""
    across = strip(e[0] + a[0] * s + b[0] * t, e[2] + a[2] * s + b[2] * t)
    return across * strip(e[1] + a[1] * s + b[1] * t, e[3] + a[3] * s + b[3] * t)


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def lay_flat(row: F32, box: I32, window: I32, target: F32) -> None:
    """Lay a quad whose brightness is a plane.

    Parameters
    ----------
    row : ndarray of float32, shape (16,)
        Its numbers, from `prepare`.
    box : ndarray of int32, shape (4,)
        Columns and rows that it touches: left, top, right, bottom.
    window : ndarray of int32, shape (4,)
        Left, top, right, bottom; left and top are multiples of 8.
    target : ndarray of float32, shape (block rows, block columns, 64)
        The window's power a pixel; added to.
    """
    a0, a1, a2, a3 = row[0], row[1], row[2], row[3]
    b0, b1, b2, b3 = row[4], row[5], row[6], row[7]
    slope_x, slope_y = row[13], row[14]
    left, top = max(box[0], window[0]), max(box[1], window[1])
    right, bottom = min(box[2], window[2]), min(box[3], window[3])
    for i in range(top >> 3, (bottom + 7) >> 3):
        for j in range(left >> 3, (right + 7) >> 3):
            x, y = np.float32(8 * j - box[0]), np.float32(8 * i - box[1])
            e0, e1 = row[8] + a0 * x + b0 * y, row[9] + a1 * x + b1 * y
            e2, e3 = row[10] + a2 * x + b2 * y, row[11] + a3 * x + b3 * y
            block = target[i - (window[1] >> 3), j - (window[0] >> 3)]
            inner = min(
                min(e0 + BLOCK_MIDDLE * (a0 + b0), e1 + BLOCK_MIDDLE * (a1 + b1)),
                min(e2 + BLOCK_MIDDLE * (a2 + b2), e3 + BLOCK_MIDDLE * (a3 + b3)),
            )
            if inner <= -BLOCK_REACH:
                continue
            level = row[12] + slope_x * x + slope_y * y
            if inner >= BLOCK_REACH:
                # Nothing of the block is outside.
                for k in range(64):
                    u = np.float32((k & 3) + ((k >> 4) & 1) * 4)
                    v = np.float32(((k >> 2) & 3) + (k >> 5) * 4)
                    block[k] += level + slope_x * u + slope_y * v
                continue
            for part in range(4):
                column, line = 8 * j + 4 * (part & 1), 8 * i + 4 * (part >> 1)
                if column >= right or column + 4 <= left or line >= bottom or line + 4 <= top:
                    continue
                x, y = np.float32(4 * (part & 1)), np.float32(4 * (part >> 1))
                f0, f1 = e0 + a0 * x + b0 * y, e1 + a1 * x + b1 * y
                f2, f3 = e2 + a2 * x + b2 * y, e3 + a3 * x + b3 * y
                inner = min(
                    min(f0 + PART_MIDDLE * (a0 + b0), f1 + PART_MIDDLE * (a1 + b1)),
                    min(f2 + PART_MIDDLE * (a2 + b2), f3 + PART_MIDDLE * (a3 + b3)),
                )
                if inner <= -PART_REACH:
                    continue
                here = level + slope_x * x + slope_y * y
                pixels = block[16 * part : 16 * part + 16]
                for k in range(16):
                    u, v = np.float32(k & 3), np.float32(k >> 2)
                    across = strip(f0 + a0 * u + b0 * v, f2 + a2 * u + b2 * v)
                    along = strip(f1 + a1 * u + b1 * v, f3 + a3 * u + b3 * v)
                    pixels[k] += across * along * (here + slope_x * u + slope_y * v)


@numba.njit(cache=True, nogil=True, fastmath=FAST)
def spread(values: F32, turned: bool) -> Four:
    """Return a bilinear number's value at the first corner, slopes in u and v, and twist."""
    second, fourth = (values[3], values[1]) if turned else (values[1], values[3])
    return values[0], second - values[0], fourth - values[0], values[0] - second + values[2] - fourth


@numba.njit(cache=True, nogil=True, fastmath=FAST)
def at(number: Four, u: Real, v: Real) -> Real:
    """Return a bilinear number at a place in the quad."""
    return number[0] + number[1] * u + number[2] * v + number[3] * (u * v)


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def slopes(middle: Five, number: Four) -> tuple[Real, Real]:
    """Return a bilinear number's slopes in x and y at the quad's middle."""
    ux, uy, vx, vy, density = middle
    along, across = number[1] + HALF * number[3], number[2] + HALF * number[3]
    return (along * vy - across * uy) * density, (across * ux - along * vx) * density


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def look_up(iris: F32, x: Real, y: Real) -> Real:
    """Return an iris's transmission at a place on the stop: bilinear between its samples, 0 outside."""
    rows, columns = iris.shape
    x, y = (x + ONE) * HALF * np.float32(columns) - HALF, (y + ONE) * HALF * np.float32(rows) - HALF
    if not (-ONE < x < np.float32(columns) and -ONE < y < np.float32(rows)):
        return ZERO
    i, j = math.floor(y), math.floor(x)
    u, v = x - np.float32(j), y - np.float32(i)
    above = (iris[i, j] if i >= 0 and j >= 0 else ZERO) * (ONE - u)
    above += (iris[i, j + 1] if i >= 0 and j + 1 < columns else ZERO) * u
    below = (iris[i + 1, j] if i + 1 < rows and j >= 0 else ZERO) * (ONE - u)
    below += (iris[i + 1, j + 1] if i + 1 < rows and j + 1 < columns else ZERO) * u
    return above * (ONE - v) + below * v


@numba.njit(inline="always")
def open_part(sx: Real, sy: Real, rates: Four) -> Real:
    """Return the part of a pixel that lies inside a round stop, of the stop's slopes over the pixel."""
    r = math.sqrt(sx * sx + sy * sy) + NEAR
    rate = abs(sx * rates[0] + sy * rates[2]) + abs(sx * rates[1] + sy * rates[3]) + TINY
    return ramp((ONE - r) * r / rate)


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def transmit(iris: F32, x: Three, y: Three, passed: F32) -> None:
    """Fill what an iris lets through at 4×4 pixels, of the planes of the place on the stop."""
    for k in range(16):
        s, t = np.float32(k & 3), np.float32(k >> 2)
        passed[k] = look_up(iris, x[0] + x[1] * s + x[2] * t, y[0] + y[1] * s + y[2] * t)


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def plane(middle: Five, number: Four, x: Real, y: Real) -> tuple[Real, Real, Real]:
    """Return a number's value at a place relative to the quad's middle, and its slopes in x and y."""
    in_x, in_y = slopes(middle, number)
    return at(number, HALF, HALF) + in_x * x + in_y * y, in_x, in_y


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def lay_edged(
    row: F32, box: I32, corners: F32, rays: F32, iris: F32, window: I32, target: F32, passed: F32
) -> None:
    """Lay a quad in which brightness, level and place on the stop are planes, and that light partly passes.

    Parameters
    ----------
    row, box, window, target : ndarray
        As in `lay_flat`.
    corners : ndarray of float32, shape (4, 2)
        Pixels.
    rays : ndarray of float32, shape (4, 4)
        Weight, level, stop_x and stop_y of each corner.
    iris : ndarray of float32, shape (rows, columns)
        Transmission over the stop; (0, 0) for a round one.
    passed : ndarray of float32, shape (48,)
        Used.
    """
    turned, is_round = row[15] < ZERO, iris.shape[0] == 0
    xs, ys = spread(corners[:, 0], turned), spread(corners[:, 1], turned)
    ux, uy, vx, vy = xs[1] + HALF * xs[3], ys[1] + HALF * ys[3], xs[2] + HALF * xs[3], ys[2] + HALF * ys[3]
    middle = ux, uy, vx, vy, ONE / (ux * vy - uy * vx)
    x, y = np.float32(box[0]) + HALF - at(xs, HALF, HALF), np.float32(box[1]) + HALF - at(ys, HALF, HALF)
    l0, lx, ly = plane(middle, spread(rays[:, 1], turned), x, y)
    p0, px, py = plane(middle, spread(rays[:, 2], turned), x, y)
    q0, qx, qy = plane(middle, spread(rays[:, 3], turned), x, y)
    steep, rates = ONE / (abs(lx) + abs(ly) + TINY), (px, py, qx, qy)
    a0, a1, a2, a3 = row[0], row[1], row[2], row[3]
    b0, b1, b2, b3 = row[4], row[5], row[6], row[7]
    a, b = (a0, a1, a2, a3), (b0, b1, b2, b3)
    d0, dx, dy = row[12], row[13], row[14]
    left, top = max(box[0], window[0]) >> 2, max(box[1], window[1]) >> 2
    right, bottom = (min(box[2], window[2]) + 3) >> 2, (min(box[3], window[3]) + 3) >> 2
    for i in range(top, bottom):
        for j in range(left, right):
            x, y = np.float32(4 * j - box[0]), np.float32(4 * i - box[1])
            e0, e1 = row[8] + a0 * x + b0 * y, row[9] + a1 * x + b1 * y
            e2, e3 = row[10] + a2 * x + b2 * y, row[11] + a3 * x + b3 * y
            inner = min(
                min(e0 + PART_MIDDLE * (a0 + b0), e1 + PART_MIDDLE * (a1 + b1)),
                min(e2 + PART_MIDDLE * (a2 + b2), e3 + PART_MIDDLE * (a3 + b3)),
            )
            if inner <= -PART_REACH:
                continue
            bright, level = d0 + dx * x + dy * y, l0 + lx * x + ly * y
            on_x, on_y = p0 + px * x + py * y, q0 + qx * x + qy * y
            block = target[(i >> 1) - (window[1] >> 3), (j >> 1) - (window[0] >> 3)]
            part = 16 * (2 * (i & 1) + (j & 1))
            pixels = block[part : part + 16]
            e, behind = (e0, e1, e2, e3), ((ONE - level) * steep, -lx * steep, -ly * steep)
            if is_round:
                for k in range(16):
                    s, t = np.float32(k & 3), np.float32(k >> 2)
                    shown = covered(e, a, b, s, t) * ramp(behind[0] + behind[1] * s + behind[2] * t)
                    inside = open_part(on_x + px * s + py * t, on_y + qx * s + qy * t, rates)
                    pixels[k] += shown * inside * max(bright + dx * s + dy * t, ZERO)
                continue
            transmit(iris, (on_x, px, py), (on_y, qx, qy), passed)
            for k in range(16):
                s, t = np.float32(k & 3), np.float32(k >> 2)
                shown = covered(e, a, b, s, t) * ramp(behind[0] + behind[1] * s + behind[2] * t)
                pixels[k] += shown * passed[k] * max(bright + dx * s + dy * t, ZERO)


@numba.njit(inline="always")
def cell_at(qx: Real, qy: Real, xs: Four, ys: Four, least: Real) -> tuple[Real, Real, Real]:
    """Return u, v of a place relative to the first corner, and the area of a unit cell there.

    The bilinear map is undone: (q - b v) × (a + c v) = 0, whose discriminant's root is that area.
    """
    ax, bx, cx, ay, by, cy = xs[1], xs[2], xs[3], ys[1], ys[2], ys[3]
    half, far = qx * cy - qy * cx + ax * by - ay * bx, ax * qy - ay * qx
    cell = math.sqrt(max(half * half + FOUR * (cx * by - cy * bx) * far, least * least))
    v = min(max(TWO * far / max(half + cell, least), -ONE), TWO)
    mx, my = ax + cx * v, ay + cy * v
    u = ((qx - bx * v) * mx + (qy - by * v) * my) / (mx * mx + my * my + TINY)
    return min(max(u, -ONE), TWO), v, cell


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def lay_curved(
    row: F32,
    box: I32,
    corners: F32,
    rays: F32,
    area: Real,
    iris: F32,
    window: I32,
    target: F32,
    found: F32,
) -> None:
    """Lay a convex quad whose brightness is curved, or that light only partly passes.

    Parameters
    ----------
    row, box, corners, rays, iris, window, target : ndarray
        As in `lay_edged`.
    area : float
        Pupil's area, m².
    found : ndarray of float32, shape (48,)
        Used.
    """
    turned, is_round = row[15] < ZERO, iris.shape[0] == 0
    xs, ys = spread(corners[:, 0], turned), spread(corners[:, 1], turned)
    weight, level = spread(rays[:, 0], turned), spread(rays[:, 1], turned)
    stop_x, stop_y = spread(rays[:, 2], turned), spread(rays[:, 3], turned)
    ux, uy, vx, vy = xs[1] + HALF * xs[3], ys[1] + HALF * ys[3], xs[2] + HALF * xs[3], ys[2] + HALF * ys[3]
    middle = ux, uy, vx, vy, ONE / (ux * vy - uy * vx)
    least = np.float32(0.05) * (ux * vy - uy * vx)
    # How fast level and place on the stop change over the picture, for the width of the ramps on their edges.
    change, in_x, in_y = slopes(middle, level), slopes(middle, stop_x), slopes(middle, stop_y)
    steep, rates = ONE / (abs(change[0]) + abs(change[1]) + TINY), (in_x[0], in_x[1], in_y[0], in_y[1])
    a0, a1, a2, a3 = row[0], row[1], row[2], row[3]
    b0, b1, b2, b3 = row[4], row[5], row[6], row[7]
    left, top = max(box[0], window[0]) >> 2, max(box[1], window[1]) >> 2
    right, bottom = (min(box[2], window[2]) + 3) >> 2, (min(box[3], window[3]) + 3) >> 2
    for i in range(top, bottom):
        for j in range(left, right):
            x, y = np.float32(4 * j - box[0]), np.float32(4 * i - box[1])
            e0, e1 = row[8] + a0 * x + b0 * y, row[9] + a1 * x + b1 * y
            e2, e3 = row[10] + a2 * x + b2 * y, row[11] + a3 * x + b3 * y
            inner = min(
                min(e0 + PART_MIDDLE * (a0 + b0), e1 + PART_MIDDLE * (a1 + b1)),
                min(e2 + PART_MIDDLE * (a2 + b2), e3 + PART_MIDDLE * (a3 + b3)),
            )
            if inner <= -PART_REACH:
                continue
            x += np.float32(box[0]) + HALF - xs[0]
            y += np.float32(box[1]) + HALF - ys[0]
            block = target[(i >> 1) - (window[1] >> 3), (j >> 1) - (window[0] >> 3)]
            part = 16 * (2 * (i & 1) + (j & 1))
            pixels = block[part : part + 16]
            for k in range(16):
                s, t = np.float32(k & 3), np.float32(k >> 2)
                cover = strip(e0 + a0 * s + b0 * t, e2 + a2 * s + b2 * t)
                cover *= strip(e1 + a1 * s + b1 * t, e3 + a3 * s + b3 * t)
                u, v, cell = cell_at(x + s, y + t, xs, ys, least)
                found[k], found[16 + k], found[32 + k] = cover * area / cell, u, v
            # Loops of their own, so that compilers find them simple.
            if is_round:
                for k in range(16):
                    u, v = found[16 + k], found[32 + k]
                    inside = open_part(at(stop_x, u, v), at(stop_y, u, v), rates)
                    inside *= ramp((ONE - at(level, u, v)) * steep)
                    pixels[k] += found[k] * max(at(weight, u, v), ZERO) * inside
                continue
            for k in range(16):
                u, v = found[16 + k], found[32 + k]
                if found[k] > ZERO:
                    inside = look_up(iris, at(stop_x, u, v), at(stop_y, u, v))
                    inside *= ramp((ONE - at(level, u, v)) * steep)
                    pixels[k] += found[k] * max(at(weight, u, v), ZERO) * inside


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def lay_rough(corners: F32, rays: F32, area: Real, plain: bool, iris: F32, window: I32, target: F32) -> None:
    """Lay a quad that is concave, crosses itself, or is tiny, as samples spread over boxes.

    Parameters
    ----------
    corners, rays, area, iris, window, target
        As in `lay_curved`.
    plain : bool
        Whether all of it is open.
    """
    turned = area < ZERO
    xs, ys = spread(corners[:, 0], turned), spread(corners[:, 1], turned)
    weight, level = spread(rays[:, 0], turned), spread(rays[:, 1], turned)
    stop_x, stop_y = spread(rays[:, 2], turned), spread(rays[:, 3], turned)
    longest = ZERO
    for k in range(4):
        dx, dy = corners[k, 0] - corners[k - 1, 0], corners[k, 1] - corners[k - 1, 1]
        longest = max(longest, dx * dx + dy * dy)
    sides: Real = min(math.sqrt(longest), np.float32(MOST_SAMPLES))
    count = math.ceil(sides)
    count = max(count, 1 if plain else 4)
    step = ONE / np.float32(count)
    for i in range(count):
        for j in range(count):
            u, v = (np.float32(j) + HALF) * step, (np.float32(i) + HALF) * step
            power = max(at(weight, u, v), ZERO) * area * step * step
            if not plain:
                # Edges of the open region are ramps over a sample here.
                ramps = abs(level[1] + level[3] * v) + abs(level[2] + level[3] * u) + TINY
                power *= ramp((ONE - at(level, u, v)) / (ramps * step))
                sx, sy = at(stop_x, u, v), at(stop_y, u, v)
                if iris.shape[0] > 0:
                    power *= look_up(iris, sx, sy)
                else:
                    rates = (
                        (stop_x[1] + stop_x[3] * v) * step,
                        (stop_x[2] + stop_x[3] * u) * step,
                        (stop_y[1] + stop_y[3] * v) * step,
                        (stop_y[2] + stop_y[3] * u) * step,
                    )
                    power *= open_part(sx, sy, rates)
            if power <= ZERO:
                continue
            # A box with the sample's variances.
            wide = math.hypot(xs[1] + xs[3] * v, xs[2] + xs[3] * u) * step
            high = math.hypot(ys[1] + ys[3] * v, ys[2] + ys[3] * u) * step
            lay_box(at(xs, u, v), at(ys, u, v), wide, high, power, window, target)


@numba.njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def lay_box(x: Real, y: Real, wide: Real, high: Real, power: Real, window: I32, target: F32) -> None:
    """Spread power evenly over a box around a place, on each pixel what lies in it."""
    wide, high = max(wide, np.float32(1e-3)), max(high, np.float32(1e-3))
    low_x, high_x, low_y, high_y = x - HALF * wide, x + HALF * wide, y - HALF * high, y + HALF * high
    if high_x <= window[0] or low_x >= window[2] or high_y <= window[1] or low_y >= window[3]:
        return
    dense = power / ((high_x - low_x) * (high_y - low_y))
    left, right = max(low_x, np.float32(window[0])), min(high_x, np.float32(window[2]))
    top, bottom = max(low_y, np.float32(window[1])), min(high_y, np.float32(window[3]))
    for i in range(math.floor(top), math.ceil(bottom)):
        in_y = min(np.float32(i + 1), high_y) - max(np.float32(i), low_y)
        for j in range(math.floor(left), math.ceil(right)):
            in_x = min(np.float32(j + 1), high_x) - max(np.float32(j), low_x)
            k = ((i >> 2 & 1) << 5) + ((j >> 2 & 1) << 4) + ((i & 3) << 2) + (j & 3)
            target[(i - window[1]) >> 3, (j - window[0]) >> 3, k] += dense * in_x * in_y

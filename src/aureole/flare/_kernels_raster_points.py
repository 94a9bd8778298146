"""Compiled loops that lay primitives by the pixels' middles, with the tile paper's barycentric coordinates.

A middle on an edge that two quads share belongs to one of them: where a row meets an edge is computed from
the edge's ends in one order, and the left end of a span is in it, the right end is not.
"""

import math
from typing import Any, TypeAlias

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.flare import _kernels_barycentric as barycentric
from aureole.flare._kernels_raster import FLAT, ROUGH, SKIPPED, lay_rough, look_up, slopes, spread
from aureole.flare._kernels_raster_tiles import add_pass, widen, write

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I8 = NDArray[np.int8]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
# A number of single precision, and several.
Real: TypeAlias = Any
Four: TypeAlias = tuple[Real, Real, Real, Real]
ZERO, HALF, ONE, TINY = np.float32(0), np.float32(0.5), np.float32(1), np.float32(1e-20)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def sweep_points(
    kinds: I8,
    boxes: I32,
    corners: F32,
    rays: F32,
    areas: F32,
    passes: I32,
    indices: I32,
    colours: F32,
    iris: F32,
    way: int,
    windows: I32,
    starts: I64,
    items: I32,
    first: int,
    last: int,
    out: F32,
) -> None:
    """Lay each window's primitives by pixels' middles, and write the windows into the picture.

    Parameters
    ----------
    kinds, boxes, corners, rays, areas, passes, indices, colours, iris
        As in `sweep`.
    way : int
        Barycentric coordinates: 0 triangle, 1 homogeneous, 2 mean value, 3 Wachspress, 4 Loop and DeRose,
        5 bilinear.
    windows, starts, items, first, last, out
        As in `sweep`.
    """
    span = np.empty(2)
    for w in range(first, last):
        window = windows[w]
        high, wide = (window[3] - window[1] + 7) >> 3, (window[2] - window[0] + 7) >> 3
        total, bare = np.zeros((3, high, wide, 64), np.float32), np.zeros((high, wide, 64), np.float32)
        touched = np.array([window[2], window[3], window[0], window[1]], np.int32)
        for k in range(starts[w], starts[w + 1]):
            p = items[k]
            if k > starts[w] and passes[p] != passes[items[k - 1]]:
                add_pass(bare, colours[indices[items[k - 1]]], window, touched, total)
            widen(touched, boxes[p])
            if abs(kinds[p]) == ROUGH:
                lay_rough(corners[p], rays[p], areas[p], kinds[p] < 0, iris, window, bare)
            elif kinds[p] != SKIPPED:
                plain = kinds[p] == FLAT
                lay_points(boxes[p], corners[p], rays[p], areas[p], plain, iris, way, window, span, bare)
        if starts[w + 1] > starts[w]:
            add_pass(bare, colours[indices[items[starts[w + 1] - 1]]], window, touched, total)
        write(total, window, out)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def lay_points(
    box: I32,
    corners: F32,
    rays: F32,
    area: Real,
    plain: bool,
    iris: F32,
    way: int,
    window: I32,
    span: F64,
    target: F32,
) -> None:
    """Lay a convex quad on the pixels whose middles it holds."""
    turned = area < ZERO
    xs, ys = spread(corners[:, 0], turned), spread(corners[:, 1], turned)
    ux, uy, vx, vy = xs[1] + HALF * xs[3], ys[1] + HALF * ys[3], xs[2] + HALF * xs[3], ys[2] + HALF * ys[3]
    middle = ux, uy, vx, vy, ONE / (ux * vy - uy * vx)
    change, in_x = slopes(middle, spread(rays[:, 1], turned)), slopes(middle, spread(rays[:, 2], turned))
    in_y = slopes(middle, spread(rays[:, 3], turned))
    steep, rates = ONE / (abs(change[0]) + abs(change[1]) + TINY), (in_x[0], in_x[1], in_y[0], in_y[1])
    # Areas of the parallelograms at the corners.
    j0, j1 = turn(corners[3], corners[0], corners[1]), turn(corners[0], corners[1], corners[2])
    j2, j3 = turn(corners[1], corners[2], corners[3]), turn(corners[2], corners[3], corners[0])
    for i in range(max(box[1], window[1]), min(box[3], window[3])):
        row_span(corners, i + 0.5, span)
        if span[0] >= window[2] or span[1] <= window[0]:
            continue
        start = max(math.ceil(max(span[0], -1.0) - 0.5), window[0])
        stop = min(math.ceil(min(span[1], 1e6) - 0.5), window[2])
        for j in range(start, stop):
            b = weights(way, corners, np.float32(j - box[0]) + HALF, np.float32(i - box[1]) + HALF, box)
            spread_out = abs(b[0] * j0 + b[1] * j1 + b[2] * j2 + b[3] * j3)
            if spread_out == ZERO:
                continue
            power = area * max(inner(b, rays[:, 0]), ZERO) / spread_out
            if not plain:
                sx, sy = inner(b, rays[:, 2]), inner(b, rays[:, 3])
                power *= passing(inner(b, rays[:, 1]), steep, sx, sy, rates, iris)
            k = ((i >> 2 & 1) << 5) + ((j >> 2 & 1) << 4) + ((i & 3) << 2) + (j & 3)
            target[(i - window[1]) >> 3, (j - window[0]) >> 3, k] += power


@numba.njit(cache=True, nogil=True)
def turn(before: F32, here: F32, after: F32) -> Real:
    """Return the cross product of a corner's two edges."""
    return (here[0] - before[0]) * (after[1] - here[1]) - (here[1] - before[1]) * (after[0] - here[0])


@numba.njit(cache=True, nogil=True)
def row_span(corners: F32, y: float, span: F64) -> None:
    """Fill where a row of middles enters and leaves a convex quad."""
    span[0], span[1] = np.inf, -np.inf
    for k in range(4):
        a, b = corners[k], corners[(k + 1) & 3]
        if (a[1] <= y) == (b[1] <= y):
            continue
        # From the upper end, whichever quad asks.
        if a[1] > b[1]:
            a, b = b, a
        x = a[0] + (y - a[1]) * (np.float64(b[0]) - a[0]) / (np.float64(b[1]) - a[1])
        span[0], span[1] = min(span[0], x), max(span[1], x)


@numba.njit(cache=True, nogil=True)
def inner(b: Four, numbers: F32) -> Real:
    """Return the weighted sum of corners' numbers."""
    return b[0] * numbers[0] + b[1] * numbers[1] + b[2] * numbers[2] + b[3] * numbers[3]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def passing(level: Real, steep: Real, sx: Real, sy: Real, rates: Four, iris: F32) -> Real:
    """Return what passes apertures and iris at a place, their edges antialiased."""
    inside = min(max((ONE - level) * steep + HALF, ZERO), ONE)
    if iris.shape[0] > 0:
        return inside * look_up(iris, sx, sy)
    r = math.sqrt(sx * sx + sy * sy) + np.float32(1e-6)
    rate = abs(sx * rates[0] + sy * rates[2]) + abs(sx * rates[1] + sy * rates[3]) + TINY
    return inside * min(max((ONE - r) * r / rate + HALF, ZERO), ONE)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def weights(way: int, corners: F32, px: Real, py: Real, box: I32) -> Four:
    """Return the corners' weights at a place relative to the box."""
    left, top = np.float32(box[0]), np.float32(box[1])
    x0, y0, x1, y1 = corners[0, 0] - left, corners[0, 1] - top, corners[1, 0] - left, corners[1, 1] - top
    x2, y2, x3, y3 = corners[2, 0] - left, corners[2, 1] - top, corners[3, 0] - left, corners[3, 1] - top
    if way == 0:
        found = barycentric.triangle(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
    elif way == 1:
        found = barycentric.homogeneous(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
    elif way == 2:
        found = barycentric.mean_value(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
    elif way == 3:
        found = barycentric.wachspress(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
    elif way == 4:
        found = barycentric.loop_derose(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
    else:
        found = barycentric.bilinear(px, py, x0, y0, x1, y1, x2, y2, x3, y3)
    return found[0], found[1], found[2], found[3]

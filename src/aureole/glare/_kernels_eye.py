"""Compiled loops of the eye's point spread function: cumulative tables, and pixels looked up in them.

A cell (i, j) of the power over frequency counts as constant. The table holds the integral over all cells
above and left of a corner, so that a rectangle's integral is four look-ups, straight lines between corners.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@njit(cache=True, nogil=True)
def add_along_rows(
    first: int,
    last: int,
    power: F32,
    y: F64,
    x: F64,
    gain_y: F64,
    gain_x: F64,
    hole: float,
    start: float,
    end: float,
    table: F64,
) -> None:
    """Fill rows of a table (R, C + 1) with sums along power (R, C), times the gains of rows and columns.

    Power at frequencies y (R,), x (C,) within the square |y|, |x| < hole is left out. What lies beyond the
    radius `start` fades over the radius's logarithm, until nothing is left at `end`.
    """
    width = math.log(end / start) if end > start else 1.0
    for i in range(first, last):
        total = 0.0
        table[i, 0] = 0.0
        for j in range(len(x)):
            radius = math.sqrt(y[i] * y[i] + x[j] * x[j])
            if radius < end and not (abs(y[i]) < hole and abs(x[j]) < hole):
                share = 1.0
                if radius > start:
                    t = math.log(end / radius) / width
                    share = t * t * (3.0 - 2.0 * t)
                total += power[i, j] * share * gain_y[i] * gain_x[j]
            table[i, j + 1] = total


@njit(cache=True, nogil=True)
def _corner(table, y, x):  # type: ignore[no-untyped-def]
    """Look a place up between corners."""
    rows, columns = table.shape
    y = min(max(y, 0.0), rows - 1.0)
    x = min(max(x, 0.0), columns - 1.0)
    i, j = min(int(y), rows - 2), min(int(x), columns - 2)
    s, t = y - i, x - j
    above = table[i, j] + t * (table[i, j + 1] - table[i, j])
    below = table[i + 1, j] + t * (table[i + 1, j + 1] - table[i + 1, j])
    return above + s * (below - above)


@njit(cache=True, nogil=True)
def add_pixels(
    first: int,
    last: int,
    table: F64,
    origin_y: float,
    origin_x: float,
    scales: F64,
    weights: F64,
    top: F64,
    bottom: F64,
    left: F64,
    right: F64,
    out: F32,
) -> None:
    """Add to rows of out (R, C, 3) the rectangles' integrals at K wavelengths, weighed by (K, 3).

    Edges (R, C) are direction cosines; times scales (K,) they count cells from the origin, which lies at
    (origin_y, origin_x) in the table.
    """
    high, wide = table.shape[0] - 1 - origin_y, table.shape[1] - 1 - origin_x
    for i in range(first, last):
        for j in range(top.shape[1]):
            red, green, blue = 0.0, 0.0, 0.0
            for k in range(len(scales)):
                scale = scales[k]
                y0, y1 = top[i, j] * scale, bottom[i, j] * scale
                x0, x1 = left[i, j] * scale, right[i, j] * scale
                if x0 < wide and y0 < high and y1 > -origin_y and x1 > -origin_x:
                    y0, y1, x0, x1 = y0 + origin_y, y1 + origin_y, x0 + origin_x, x1 + origin_x
                    value = _corner(table, y1, x1) - _corner(table, y0, x1)
                    value -= _corner(table, y1, x0) - _corner(table, y0, x0)
                    red += value * weights[k, 0]
                    green += value * weights[k, 1]
                    blue += value * weights[k, 2]
            out[i, j, 0] += red
            out[i, j, 1] += green
            out[i, j, 2] += blue

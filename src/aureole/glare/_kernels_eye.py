"""Compiled loops of the eye's point spread function: cumulative tables, and pixels looked up in them.

A cell (i, j) of the power over frequency counts as constant. The table holds the integral over all cells
above and left of a corner, so that a rectangle's integral is four look-ups, straight lines between corners.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

# Pixels side by side that share their edges along y.
BLOCK = 8

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
def _strip(table, i0, s0, i1, s1, x):  # type: ignore[no-untyped-def]
    """Look up the integral left of x between two places along y, each a row and a part of the next."""
    x = min(max(x, 0.0), table.shape[1] - 1.0)
    j = min(int(x), table.shape[1] - 2)
    t = x - j
    left = table[i1, j] + s1 * (table[i1 + 1, j] - table[i1, j])
    left -= table[i0, j] + s0 * (table[i0 + 1, j] - table[i0, j])
    right = table[i1, j + 1] + s1 * (table[i1 + 1, j + 1] - table[i1, j + 1])
    right -= table[i0, j + 1] + s0 * (table[i0 + 1, j + 1] - table[i0, j + 1])
    return left + t * (right - left)


@njit(cache=True, nogil=True)
def add_pixels(
    first: int,
    last: int,
    table: F64,
    origin_y: float,
    origin_x: float,
    scales: F64,
    weights: F32,
    y: F64,
    x: F64,
    out: F32,
) -> None:
    """Add to rows of out (R, C, 3) the pixels' integrals at K wavelengths, weighed by (K, 3).

    Pixels lie between edges y (R + 1, C) and x (R, C + 1), direction cosines; times scales (K,) they count
    cells from the origin, which lies at (origin_y, origin_x) in the table. A few pixels side by side take
    the edges along y of their middle one.
    """
    columns = out.shape[1]
    high, wide = table.shape[0] - 1.0, table.shape[1] - 1.0
    for i in range(first, last):
        for begin in range(0, columns, BLOCK):
            end = min(begin + BLOCK, columns)
            middle = (begin + end) // 2
            for k in range(len(scales)):
                scale = scales[k]
                y0 = min(max(y[i, middle] * scale + origin_y, 0.0), high)
                y1 = min(max(y[i + 1, middle] * scale + origin_y, 0.0), high)
                if y1 == y0 or x[i, begin] * scale + origin_x >= wide or x[i, end] * scale + origin_x <= 0.0:
                    continue
                i0, i1 = min(int(y0), table.shape[0] - 2), min(int(y1), table.shape[0] - 2)
                before = _strip(table, i0, y0 - i0, i1, y1 - i1, x[i, begin] * scale + origin_x)
                for j in range(begin, end):
                    after = _strip(table, i0, y0 - i0, i1, y1 - i1, x[i, j + 1] * scale + origin_x)
                    value = np.float32(after - before)
                    before = after
                    for channel in range(3):
                        out[i, j, channel] += value * weights[k, channel]

"""Compiled loops of the aperture room: exact coverage of pixels by polygons."""

import math

import numba
import numpy as np
from numpy.typing import NDArray


@numba.njit(cache=True)
def accumulate_edges(points: NDArray[np.float64], coverage: NDArray[np.float64]) -> None:
    """Add each edge's signed area to the right of it, as differences along the row.

    The running sum of a row is the part of each pixel that the ring covers, signed by the ring's
    direction: the integral over the pixel's height of the part of it that lies right of the edge.

    Parameters
    ----------
    points : ndarray, shape (V, 2)
        Corners (x, y) in pixels; the last joins the first.
    coverage : ndarray, shape (rows, columns + 2)
        Added to in place.
    """
    rows, columns = coverage.shape[0], coverage.shape[1] - 2
    for index in range(len(points)):
        x0, y0 = points[index]
        x1, y1 = points[(index + 1) % len(points)]
        if y0 == y1:
            continue
        # An edge that runs down covers what lies left of it positively, so the sign is turned.
        sign = -1.0
        if y0 > y1:
            x0, y0, x1, y1 = x1, y1, x0, y0
            sign = 1.0
        slope = (x1 - x0) / (y1 - y0)
        # From the nearer end an edge that comes from far away keeps its digits.
        x, y = (x0, y0) if abs(y0) < abs(y1) else (x1, y1)
        top = max(0, math.floor(y0))
        bottom = min(rows, math.ceil(y1))
        for row in range(top, bottom):
            low, high = max(y0, float(row)), min(y1, float(row + 1))
            if high <= low:
                continue
            _accumulate_row(
                coverage[row],
                columns,
                x + (low - y) * slope,
                x + (high - y) * slope,
                sign * (high - low),
            )


@numba.njit(cache=True)
def _accumulate_row(row: NDArray[np.float64], columns: int, start: float, end: float, height: float) -> None:
    """Spread one row's share of an edge over the pixels that it crosses."""
    left = min(max(min(start, end), 0.0), float(columns))
    right = min(max(max(start, end), 0.0), float(columns))
    # The parts beyond the borders run vertically along them.
    span = max(start, end) - min(start, end)
    if span > 0:
        before = max(0.0, min(0.0, max(start, end)) - min(start, end)) / span
        after = max(0.0, max(start, end) - max(float(columns), min(start, end))) / span
    else:
        before = 1.0 if start < 0 else 0.0
        after = 1.0 if start > columns else 0.0
    row[0] += height * before
    row[columns] += height * after
    inner = height * (1 - before - after)
    if inner == 0:
        return
    if right - left < 1e-12:
        pixel = int(left)
        part = left - pixel
        row[pixel] += inner * (1 - part)
        row[pixel + 1] += inner * part
        return
    density = inner / (right - left)
    for pixel in range(int(left), math.ceil(right)):
        low, high = max(left, float(pixel)), min(right, float(pixel + 1))
        amount = density * (high - low)
        part = (low + high) / 2 - pixel
        row[pixel] += amount * (1 - part)
        row[pixel + 1] += amount * part

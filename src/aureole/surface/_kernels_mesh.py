"""Which triangle of a mesh each ray of a view meets first, and the frame there: edge functions and depths.

Corners are taken to the view's coordinates (x, y, w), w their depth in perspective and 1 for parallel rays.
Edge functions of the rays (x, y, 1) are then linear over the picture, and exact for triangles that reach
behind the eye.
"""

import math

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

_BAND = 16


@njit(cache=True)
def _project(attributes, sight, perspective, corners):  # type: ignore[no-untyped-def]
    """Fill corners (V, 4) with x, y, w and depth; x and y are 1 at the picture's border where w is 1."""
    wide = sight[1, 0] ** 2 + sight[1, 1] ** 2 + sight[1, 2] ** 2
    high = sight[2, 0] ** 2 + sight[2, 1] ** 2 + sight[2, 2] ** 2
    for i in range(attributes.shape[0]):
        x = y = z = 0.0
        for k in range(3):
            away = attributes[i, k] - sight[0, k]
            x += away * sight[1, k]
            y += away * sight[2, k]
            z += away * sight[3, k]
        corners[i, 0], corners[i, 1], corners[i, 3] = x / wide, y / high, z
        corners[i, 2] = z if perspective else 1.0


@njit(cache=True)
def _rows_of(triangles, corners, rows, spans):  # type: ignore[no-untyped-def]
    """Fill spans (T, 2) with the first row of samples of each triangle and the one after its last."""
    for t in range(triangles.shape[0]):
        low, high, behind = math.inf, -math.inf, 0
        for k in range(3):
            _, y, w, z = corners[triangles[t, k]]
            behind += z <= 0.0
            if w > 0.0:
                low, high = min(low, y / w), max(high, y / w)
            else:
                low, high = -math.inf, math.inf
        first, last = 0, rows
        if high < math.inf:
            first = max(0, math.floor(min(max(0.5 * (1.0 - high), 0.0), 1.0) * rows))
            last = min(rows, math.ceil(min(max(0.5 * (1.0 - low), 0.0), 1.0) * rows) + 1)
        spans[t, 0], spans[t, 1] = first, 0 if behind == 3 else last


@njit(cache=True)
def _edges(a, b, c, y, e):  # type: ignore[no-untyped-def]
    """Fill e with each corner's edge function along a row: its slope over x and its value at x = 0."""
    e[0, 0], e[0, 1] = b[1] * c[2] - b[2] * c[1], (b[2] * c[0] - b[0] * c[2]) * y + b[0] * c[1] - b[1] * c[0]
    e[1, 0], e[1, 1] = c[1] * a[2] - c[2] * a[1], (c[2] * a[0] - c[0] * a[2]) * y + c[0] * a[1] - c[1] * a[0]
    e[2, 0], e[2, 1] = a[1] * b[2] - a[2] * b[1], (a[2] * b[0] - a[0] * b[2]) * y + a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def _draw_row(corner, y, columns, number, e, nearest, found):  # type: ignore[no-untyped-def]
    """Write a triangle's number and corner weights wherever it is the nearest so far along a row."""
    _edges(corner[0], corner[1], corner[2], y, e)
    # Where all three functions have one sign: between the crossings of each.
    for sign in (1.0, -1.0):
        low, high = -1.0, 1.0
        for k in range(3):
            slope, value = sign * e[k, 0], sign * e[k, 1]
            if slope > 0.0:
                low = max(low, -value / slope)
            elif slope < 0.0:
                high = min(high, -value / slope)
            elif value < 0.0:
                high = -2.0
        if low > high:
            continue
        first = max(0, math.ceil(0.5 * (low + 1.0) * columns - 0.5))
        last = min(columns - 1, math.floor(0.5 * (high + 1.0) * columns - 0.5))
        for j in range(first, last + 1):
            x = (2.0 * j + 1.0) / columns - 1.0
            f0, f1, f2 = e[0, 0] * x + e[0, 1], e[1, 0] * x + e[1, 1], e[2, 0] * x + e[2, 1]
            total = f0 + f1 + f2
            if total == 0.0:
                continue
            f0, f1, f2 = f0 / total, f1 / total, f2 / total
            depth = f0 * corner[0, 3] + f1 * corner[1, 3] + f2 * corner[2, 3]
            if 0.0 < depth < nearest[j]:
                nearest[j] = depth
                found[j, 0], found[j, 1], found[j, 2], found[j, 3] = number, f0, f1, f2


@njit(cache=True)
def _frame(triangle, weights, attributes, sight, perspective, frame):  # type: ignore[no-untyped-def]
    """Blend the corners' attributes, make the frame orthonormal and turn its normal to the eye."""
    for k in range(12):
        blend = 0.0
        for m in range(3):
            blend += weights[1 + m] * attributes[triangle[m], k]
        frame[1 + k] = blend
    sign = 1.0 if attributes[triangle[0], 9] > 0.0 else -1.0
    for k in range(3):
        frame[13 + k] = sight[0, k] - frame[1 + k] if perspective else -sight[3, k]
    for first in (4, 13):
        scale = 1.0 / math.sqrt(frame[first] ** 2 + frame[first + 1] ** 2 + frame[first + 2] ** 2 + 1e-60)
        for k in range(3):
            frame[first + k] *= scale
    along = frame[4] * frame[7] + frame[5] * frame[8] + frame[6] * frame[9]
    for k in range(3):
        frame[7 + k] -= along * frame[4 + k]
    scale = 1.0 / math.sqrt(frame[7] ** 2 + frame[8] ** 2 + frame[9] ** 2 + 1e-60)
    facing = 0.0
    for k in range(3):
        frame[7 + k] *= scale
        facing += frame[4 + k] * frame[13 + k]
    if facing < 0.0:
        sign = -sign
        for k in range(3):
            frame[4 + k] = -frame[4 + k]
    frame[0], frame[10] = 1.0, sign


@njit(cache=True, parallel=True)
def raster(
    triangles: NDArray[np.int64],
    attributes: NDArray[np.float64],
    sight: NDArray[np.float64],
    perspective: bool,
    size: NDArray[np.int64],
    frames: NDArray[np.float32],
) -> None:
    """Fill zeroed frames (rows, columns, 17) for the rows of samples from `size[2]` on.

    Attributes (V, 12) are place, normal, tangent, sign of the bitangent, texture coordinates.
    """
    rows, columns, begin = size
    corners = np.empty((attributes.shape[0], 4))
    _project(attributes, sight, perspective, corners)
    spans = np.empty((triangles.shape[0], 2), np.int64)
    _rows_of(triangles, corners, rows, spans)
    count = frames.shape[0]
    for band in prange((count + _BAND - 1) // _BAND):
        top, bottom = begin + band * _BAND, begin + min(count, (band + 1) * _BAND)
        nearest = np.full((_BAND, columns), np.inf)
        found = np.empty((_BAND, columns, 4))
        corner, scratch, edges = np.empty((3, 4)), np.empty(17), np.empty((3, 2))
        for t in range(triangles.shape[0]):
            first, last = max(top, spans[t, 0]), min(bottom, spans[t, 1])
            if first >= last:
                continue
            for k in range(3):
                corner[k] = corners[triangles[t, k]]
            for i in range(first, last):
                y = 1.0 - (2.0 * i + 1.0) / rows
                _draw_row(corner, y, columns, t, edges, nearest[i - top], found[i - top])
        for i in range(top, bottom):
            for j in range(columns):
                frame = frames[i - begin, j]
                if nearest[i - top, j] < np.inf:
                    weights = found[i - top, j]
                    _frame(triangles[int(weights[0])], weights, attributes, sight, perspective, scratch)
                    frame[:] = scratch
                    frame[16] = nearest[i - top, j]

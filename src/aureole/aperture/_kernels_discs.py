"""Compiled loop of the aperture room: exact coverage of pixels by discs."""

import math

import numba
import numpy as np
from numpy.typing import NDArray


@numba.njit(cache=True, nogil=True)
def uncover_discs(
    centres: NDArray[np.float64],
    radii: NDArray[np.float64],
    pixels: NDArray[np.float32],
    first: int,
    last: int,
) -> None:
    """Multiply each pixel by the part of it that a disc leaves free, disc after disc.

    Parameters
    ----------
    centres : ndarray, shape (N, 2)
        (x, y) in pixels; pixel (i, j) tiles j..j + 1 and i..i + 1.
    radii : ndarray, shape (N,)
        Pixels.
    pixels : ndarray of float32, shape (rows, columns)
        Multiplied in place.
    first, last : int
        Rows first..last − 1 are served, so that threads can share the work.
    """
    columns = pixels.shape[1]
    across = np.empty(columns + 1)
    for index in range(len(radii)):
        radius, x, y = radii[index], centres[index, 0], centres[index, 1]
        top, bottom = max(first, math.floor(y - radius)), min(last, math.ceil(y + radius))
        left, right = max(0, math.floor(x - radius)), min(columns, math.ceil(x + radius))
        if top >= bottom or left >= right:
            continue
        for column in range(left, right + 1):
            across[column] = _strip(column - x, radius)
        above = _strip(top - y, radius)
        for row in range(top, bottom):
            low, high = row - y, row + 1 - y
            below = _strip(high, radius)
            # Pixels between the chords of both edges of the row are covered wholly.
            half = math.sqrt(max(0.0, radius * radius - max(low * low, high * high)))
            start, end = math.ceil(x - half), math.floor(x + half) - 1
            corner_low = _corner(left - x, low, across[left], above, radius)
            corner_high = _corner(left - x, high, across[left], below, radius)
            for column in range(left, right):
                # The last of them is measured, with all that were passed over: more than a whole pixel.
                if start <= column < end:
                    pixels[row, column] = 0
                    continue
                next_low = _corner(column + 1 - x, low, across[column + 1], above, radius)
                next_high = _corner(column + 1 - x, high, across[column + 1], below, radius)
                covered = next_high - next_low - corner_high + corner_low
                pixels[row, column] *= min(max(1 - covered, 0.0), 1.0)
                corner_low, corner_high = next_low, next_high
            above = below


@numba.njit(cache=True, inline="always")
def _strip(offset: float, radius: float) -> float:
    """Return the area of the disc between its diameter and a parallel chord, signed as the offset."""
    offset = min(max(offset, -radius), radius)
    return offset * math.sqrt(radius * radius - offset * offset) + radius * radius * math.asin(
        offset / radius
    )


@numba.njit(cache=True, inline="always")
def _corner(x: float, y: float, strip_x: float, strip_y: float, radius: float) -> float:
    """Return the area of the disc about the origin that lies left of x and above y."""
    half = math.pi * radius * radius / 2
    if x * x + y * y < radius * radius:
        return x * y + (strip_x + strip_y + half) / 2
    if x < 0:
        return half + strip_x if y >= 0 else 0.0
    return strip_x + strip_y if y >= 0 else half + strip_y

"""The heavy loop of the spectral sum: plain arrays and numbers in, one array filled.

It reads a pattern padded with `BEFORE` zeros in front of and `AFTER` zeros behind each axis, so that
every tap of a clipped position exists. A position arrives as the unsigned index of its first tap in
the padded pattern and the fraction 0..1 past the tap that it follows; unsigned, because signed ones
cost a wrap-around check a gather. The number of wavelengths is a multiple of `GROUP`.
"""

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

BEFORE = 3
AFTER = 4
GROUP = 5
_BLOCK = 8  # output rows that share one set of buffers


@njit(cache=True, fastmath={"contract"}, inline="always")
def _linear_line(padded, row, t, index, fraction, blended, line):  # type: ignore[no-untyped-def]
    """Blend two rows of the pattern once, then interpolate along the blended row."""
    columns = index.size
    above, below = padded[row], padded[row + 1]
    for j in range(index[0], index[columns - 1] + 2):
        blended[j] = above[j] + (below[j] - above[j]) * t
    for j in range(columns):
        left = blended[index[j]]
        line[j] = left + (blended[index[j] + np.uint32(1)] - left) * fraction[j]


@njit(cache=True, fastmath={"contract"}, inline="always")
def _catmull_rom(a, b, c, d, t):  # type: ignore[no-untyped-def]
    """Evaluate the cubic through b and c whose slopes there are (c − a)/2 and (d − b)/2."""
    bend = np.float32(3.0) * (b - c) + d - a
    bow = a + a - np.float32(5.0) * b + np.float32(4.0) * c - d
    return b + np.float32(0.5) * t * ((c - a) + t * (bow + t * bend))


@njit(cache=True, fastmath={"contract"}, inline="always")
def _cubic_line(padded, row, t, index, fraction, blended, line):  # type: ignore[no-untyped-def]
    """Blend four rows of the pattern once, interpolate along the blended row, clip at zero."""
    columns = index.size
    r0, r1, r2, r3 = padded[row], padded[row + 1], padded[row + 2], padded[row + 3]
    for j in range(index[0], index[columns - 1] + 4):
        blended[j] = _catmull_rom(r0[j], r1[j], r2[j], r3[j], t)
    for j in range(columns):
        k = index[j]
        a, b = blended[k], blended[k + np.uint32(1)]
        c, d = blended[k + np.uint32(2)], blended[k + np.uint32(3)]
        line[j] = max(_catmull_rom(a, b, c, d, fraction[j]), np.float32(0.0))


@njit(cache=True, fastmath={"contract"}, inline="always")
def add_group(lines, weights, first, sums):  # type: ignore[no-untyped-def]
    """Add five wavelengths' samples of one row to its three channels."""
    for channel in range(3):
        w0, w1 = weights[first, channel], weights[first + 1, channel]
        w2, w3, w4 = weights[first + 2, channel], weights[first + 3, channel], weights[first + 4, channel]
        for j in range(sums.shape[1]):
            pairs = (w0 * lines[0, j] + w1 * lines[1, j]) + (w2 * lines[2, j] + w3 * lines[3, j])
            sums[channel, j] += pairs + w4 * lines[4, j]


@njit(cache=True, parallel=True, fastmath={"contract"})
def sum_wavelengths(
    padded: NDArray[np.float32],
    taps: int,
    row_index: NDArray[np.uint32],
    row_fraction: NDArray[np.float32],
    column_index: NDArray[np.uint32],
    column_fraction: NDArray[np.float32],
    weights: NDArray[np.float32],
    out: NDArray[np.float32],
) -> None:
    """Fill out (R, C, 3) with the sum over K wavelengths of weights (K, 3) × interpolated pattern.

    Indices and fractions are (K, R) and (K, C), rising. Taps are 2 (linear) or 4 (cubic).
    """
    count, rows = row_index.shape
    columns = column_index.shape[1]
    last = padded.shape[0] - AFTER
    for block in prange((rows + _BLOCK - 1) // _BLOCK):
        blended = np.zeros(padded.shape[1], np.float32)
        lines = np.zeros((GROUP, columns), np.float32)
        sums = np.zeros((3, columns), np.float32)
        for i in range(block * _BLOCK, min(rows, (block + 1) * _BLOCK)):
            sums[:] = np.float32(0.0)
            for first in range(0, count, GROUP):
                for m in range(GROUP):
                    k = first + m
                    row, t = row_index[k, i], row_fraction[k, i]
                    if row + taps <= BEFORE or row >= last:  # outside the pattern
                        lines[m, :] = np.float32(0.0)
                    elif taps == 2:
                        _linear_line(padded, row, t, column_index[k], column_fraction[k], blended, lines[m])
                    else:
                        _cubic_line(padded, row, t, column_index[k], column_fraction[k], blended, lines[m])
                add_group(lines, weights, first, sums)
            for j in range(columns):
                for channel in range(3):
                    out[i, j, channel] = sums[channel, j]


@njit(cache=True, parallel=True)
def turn(pixels: NDArray[np.float32], centre: int) -> None:
    """Fill the rows below `centre` of pixels (R, C, 3) with those above, turned by 180°.

    Where C is even the first column has no partner and is left as it was.
    """
    rows, columns = pixels.shape[:2]
    lone = 1 - columns % 2
    for i in prange(centre + 1, rows):
        for j in range(lone, columns):
            for channel in range(3):
                pixels[i, j, channel] = pixels[2 * centre - i, columns - 1 + lone - j, channel]

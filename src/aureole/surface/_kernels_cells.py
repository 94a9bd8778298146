"""The loop of a table's cells: a pattern, linear between its samples, averaged over rows' and columns' cells.

Averages along rows are taken first, of whole rows at a time, so that each sample of the pattern is read about
once a wavelength however wide the cells are. Indices are unsigned: signed ones cost a wrap-around check.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from aureole.light._kernels import GROUP, add_group


@njit(cache=True, fastmath={"contract"})
def _blend(framed, low, high, share, first, last, blended):  # type: ignore[no-untyped-def]
    """Average rows from low to high: between two rows the mean is the value half-way of what is covered."""
    target = blended[first:last]
    for n in range(int(low), int(high) + 1):
        start, stop = max(low, float(n)), min(high, n + 1.0)
        part, middle = (stop - start) * share, 0.5 * (start + stop) - n
        above, below = np.float32(part * (1.0 - middle)), np.float32(part * middle)
        one, other = framed[n, first:last], framed[n + 1, first:last]
        if n == int(low):
            for j in range(target.size):
                target[j] = above * one[j] + below * other[j]
        elif part > 0.0:
            for j in range(target.size):
                target[j] += above * one[j] + below * other[j]


@njit(cache=True, fastmath={"contract"})
def _along(blended, first, shares, taps, line):  # type: ignore[no-untyped-def]
    """Average a row over the columns' cells, which take three samples, or `taps`, by their shares."""
    one, two = np.uint32(1), np.uint32(2)
    for j in range(line.size):
        n = first[j]
        near = shares[0, j] * blended[n] + shares[1, j] * blended[n + one]
        line[j] = near + shares[2, j] * blended[n + two]
    for tap in range(3, taps):
        step, share = np.uint32(tap), shares[tap]
        for j in range(line.size):
            line[j] += share[j] * blended[first[j] + step]


@njit(cache=True, nogil=True, fastmath={"contract"})
def add_cells(
    framed: NDArray[np.float32],
    rows: NDArray[np.float64],
    first: NDArray[np.uint32],
    shares: NDArray[np.float32],
    spans: NDArray[np.int64],
    weights: NDArray[np.float32],
    out: NDArray[np.float32],
    begin: int,
    stop: int,
) -> None:
    """Add to rows of out (R, C, 3) the sum over K wavelengths of weights (K, 3) × means of a framed pattern.

    Rows (K, 3, R) are low and high ends and 1 / width. A column's cell takes samples from first (K, C) on by
    shares (K, T, C). Of the columns, spans (K, 4) are where those in the pattern begin, where those among
    them that need only three samples begin and end, and where all end. K is a multiple of GROUP.
    """
    (count, width), taps = first.shape, shares.shape[1]
    blended = np.zeros(framed.shape[1], np.float32)
    lines = np.zeros((GROUP, width), np.float32)
    sums = np.zeros((3, width), np.float32)
    for i in range(begin, stop):
        sums[:] = np.float32(0.0)
        for group in range(0, count, GROUP):
            for m in range(GROUP):
                k, line = group + m, lines[m]
                line[:] = np.float32(0.0)
                low, high = rows[k, 0, i], rows[k, 1, i]
                start, left, right, end = spans[k]
                if start < end and low < high:
                    one, other = np.int64(first[k, start]), np.int64(first[k, end - 1]) + taps
                    _blend(framed, low, high, rows[k, 2, i], one, other, blended)
                    for a, b, most in ((start, left, taps), (left, right, 3), (right, end, taps)):
                        _along(blended, first[k, a:b], shares[k, :, a:b], most, line[a:b])
            add_group(lines, weights, group, sums)
        for j in range(width):
            for channel in range(3):
                out[i, j, channel] += sums[channel, j]

"""The first pass of the batched spectral sum: a pattern's neighbours along the scaling line, added up.

Positions are as in `_kernels`. Neighbours are scaled by almost 1, so that along a row their indices rise
by one at a time except at a few jumps: between these, samples are read one after the other, without
gathers.
"""

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from aureole.light._kernels import AFTER, BEFORE

_BLOCK = 8  # rows that share one buffer


@njit(cache=True, fastmath={"contract"}, inline="always")
def _catmull_rom(a, b, c, d, t):  # type: ignore[no-untyped-def]
    """Evaluate the cubic through b and c whose slopes there are (c − a)/2 and (d − b)/2."""
    bend = np.float32(3.0) * (b - c) + d - a
    bow = a + a - np.float32(5.0) * b + np.float32(4.0) * c - d
    return b + np.float32(0.5) * t * ((c - a) + t * (bow + t * bend))


@njit(cache=True, fastmath={"contract"}, inline="always")
def _blend(source, dark, first, taps, t, line):  # type: ignore[no-untyped-def]
    """Interpolate between two or four rows of the pattern, which is dark outside."""
    rows = source.shape[0]
    r0 = source[first] if 0 <= first < rows else dark
    r1 = source[first + 1] if 0 <= first + 1 < rows else dark
    if taps == 2:
        for j in range(line.size):
            line[j] = r0[j] + (r1[j] - r0[j]) * t
    else:
        r2 = source[first + 2] if 0 <= first + 2 < rows else dark
        r3 = source[first + 3] if 0 <= first + 3 < rows else dark
        for j in range(line.size):
            line[j] = _catmull_rom(r0[j], r1[j], r2[j], r3[j], t)


@njit(cache=True, fastmath={"contract"}, inline="always")
def _add_run(line, shift, taps, fraction, share, start, stop, total):  # type: ignore[no-untyped-def]
    """Add share × the values between neighbours of a line to samples start to stop."""
    zero, one, two, three = np.uint64(0), np.uint64(1), np.uint64(2), np.uint64(3)
    first, frame = np.uint64(shift), np.uint64(BEFORE)
    if taps == 2:
        for j in range(np.uint64(start), np.uint64(stop)):
            a, b = line[first + j + zero], line[first + j + one]
            total[frame + j] += share * (a + (b - a) * fraction[j])
    else:
        for j in range(np.uint64(start), np.uint64(stop)):
            a, b = line[first + j], line[first + j + one]
            c, d = line[first + j + two], line[first + j + three]
            total[frame + j] += share * max(_catmull_rom(a, b, c, d, fraction[j]), np.float32(0.0))


@njit(cache=True, parallel=True, fastmath={"contract"})
def add_neighbours(
    source: NDArray[np.float32],
    taps: int,
    row_index: NDArray[np.uint32],
    row_fraction: NDArray[np.float32],
    column_index: NDArray[np.uint32],
    column_fraction: NDArray[np.float32],
    jumps: NDArray[np.int64],
    shares: NDArray[np.float32],
    total: NDArray[np.float32],
) -> None:
    """Add to the inner columns of padded rows, total (R, ·), the sum of K neighbours' shares (K,).

    The source (·, C) has no frame; positions are those in a frame, indices and fractions (K, R) and (K, C).
    Along row k of the columns' indices `jumps` (K, J) holds the places where they do not rise by one,
    between 0 and C, and C again and again after the last.
    """
    count, rows = row_index.shape
    columns = source.shape[1]
    for block in prange((rows + _BLOCK - 1) // _BLOCK):
        line = np.zeros(columns + BEFORE + AFTER, np.float32)
        dark = np.zeros(columns, np.float32)
        inner = line[BEFORE : BEFORE + columns]
        for i in range(block * _BLOCK, min(rows, (block + 1) * _BLOCK)):
            for k in range(count):
                first = np.int64(row_index[k, i]) - BEFORE
                _blend(source, dark, first, taps, row_fraction[k, i], inner)
                for run in range(jumps.shape[1] - 1):
                    start, stop = jumps[k, run], jumps[k, run + 1]
                    if start < stop:
                        shift = np.int64(column_index[k, start]) - start
                        _add_run(line, shift, taps, column_fraction[k], shares[k], start, stop, total[i])

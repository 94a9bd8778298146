"""Compiled loops of the far field of rectangles: factors of intervals, and sums of them."""

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
C64 = NDArray[np.complex64]


@numba.njit(cache=True, parallel=True)
def interval_factors(
    coarse: C64,
    fine: C64,
    sizes: F32,
    which_place: NDArray[np.int64],
    which_size: NDArray[np.int64],
    out: F32,
) -> None:
    """Fill the even and the odd factor of intervals: a size's transform times the phase of a place.

    Parameters
    ----------
    coarse : ndarray of complex64, shape (C, A)
        exp(i2πuc) of each place at every B-th frequency.
    fine : ndarray of complex64, shape (C, B)
        exp(i2πuc) of each place at the first B multiples of the spacing.
    sizes : ndarray of float32, shape (S, M)
        Transform of a box of each size about the origin.
    which_place, which_size : ndarray of int64, shape (K,)
        Of each interval.
    out : ndarray of float32, shape (2, K, M)
        Filled.
    """
    count, block = sizes.shape[1], fine.shape[1]
    for key in numba.prange(len(which_place)):
        steps, size = fine[which_place[key]], sizes[which_size[key]]
        even, odd = out[0, key], out[1, key]
        for a in range(coarse.shape[1]):
            turn = coarse[which_place[key], a]
            real, imaginary = turn.real, turn.imag
            low = a * block
            for b in range(min(block, count - low)):
                step = steps[b]
                even[low + b] = size[low + b] * (real * step.real - imaginary * step.imag)
                odd[low + b] = size[low + b] * (real * step.imag + imaginary * step.real)


@numba.njit(cache=True, parallel=True)
def weighted_sums(
    starts: NDArray[np.int32], places: NDArray[np.int32], weights: F32, rows: F32, out: F32
) -> None:
    """Fill weighted sums of rows: a sparse matrix times a dense one.

    Parameters
    ----------
    starts : ndarray of int32, shape (R + 1,)
        Where each sum's entries start, and where the last ends.
    places : ndarray of int32, shape (N,)
        Row of each entry.
    weights : ndarray of float32, shape (N,)
        Weight of each entry.
    rows : ndarray of float32, shape (K, M)
        What is summed.
    out : ndarray of float32, shape (R, M)
        Filled.
    """
    for row in numba.prange(len(out)):
        total = out[row]
        total[:] = 0
        for index in range(starts[row], starts[row + 1]):
            weight, source = weights[index], rows[places[index]]
            for j in range(len(total)):
                total[j] += weight * source[j]

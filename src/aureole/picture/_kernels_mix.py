"""Sums of kernels' spectra in half precision, times a picture's spectrum.

Spectra have shape (count, channels, blocks, n, numbers): blocks as in `_kernels`, without the padding;
numbers are LANES real parts and, where the kernels are not even, LANES imaginary parts. A half float is
widened by shifting its bits into a single float, whose exponent is then 112 too low: the caller's
weights are to hold the factor 2^112. Halves below the normal range must be zero.
"""

import numpy as np
from numba import njit

from aureole.picture._kernels import LANES


@njit(fastmath=True, cache=True, nogil=True)
def _add_row(bits, weight, shifted, floats, total):  # type: ignore[no-untyped-def]
    """Add a row of half floats, widened and weighted."""
    for k in range(len(bits)):
        half = np.uint32(bits[k])
        shifted[k] = ((half & np.uint32(0x7FFF)) << np.uint32(13)) | (
            (half & np.uint32(0x8000)) << np.uint32(16)
        )
    for k in range(len(bits)):
        total[k] += weight * floats[k]


@njit(fastmath=True, cache=True, nogil=True)
def multiply_mix(w, spectra, chosen, weights, channel, block, sum_of_all):  # type: ignore[no-untyped-def]
    """Multiply a work array by a weighted sum of spectra; the sum over all pixels is given exactly."""
    numbers = spectra.shape[4]
    shifted, total = np.empty(numbers, np.uint32), np.empty(numbers, np.float32)
    floats = shifted.view(np.float32)
    for i in range(len(w)):
        total[:] = 0
        for j in range(len(chosen)):
            _add_row(spectra[chosen[j], channel, block, i], weights[j], shifted, floats, total)
        if block == 0 and i == 0:
            total[0] = sum_of_all
        a = w[i]
        if numbers == LANES:
            for k in range(LANES):
                a[k], a[LANES + k] = a[k] * total[k], a[LANES + k] * total[k]
        else:
            for k in range(LANES):
                c, s = total[k], total[LANES + k]
                a[k], a[LANES + k] = a[k] * c - a[LANES + k] * s, a[k] * s + a[LANES + k] * c

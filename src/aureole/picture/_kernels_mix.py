"""Sums of kernels' spectra in 16 bits, times a picture's spectrum.

Spectra have shape (count, channels, blocks, n, numbers): blocks as in `_kernels`, without the padding;
numbers are LANES real parts and, where the kernels are not even, LANES imaginary parts. Each row of numbers
is in whole steps of its own size, which is kept beside it.
"""

import numpy as np
from numba import njit

from aureole.picture._kernels import LANES


@njit(fastmath=True, cache=True, nogil=True)
def _add(spectra, steps, weight, total):  # type: ignore[no-untyped-def]
    """Add one weighted spectrum: whole numbers times the size of their row's steps."""
    for i in range(len(total)):
        a, t, size = spectra[i], total[i], weight * steps[i]
        for k in range(len(a)):
            t[k] += size * np.float32(a[k])


@njit(fastmath=True, cache=True, nogil=True)
def multiply_mix(w, spectra, steps, chosen, weights, channel, block, sum_of_all):  # type: ignore[no-untyped-def]
    """Multiply a work array by a weighted sum of spectra; the sum over all pixels is given exactly."""
    numbers = spectra.shape[4]
    total = np.zeros((len(w), numbers), np.float32)
    for j in range(len(chosen)):
        _add(spectra[chosen[j], channel, block], steps[chosen[j], channel, block], weights[j], total)
    if block == 0:
        total[0, 0] = sum_of_all
    for i in range(len(w)):
        a, t = w[i], total[i]
        if numbers == LANES:
            for k in range(LANES):
                a[k], a[LANES + k] = a[k] * t[k], a[LANES + k] * t[k]
        else:
            for k in range(LANES):
                c, s = t[k], t[LANES + k]
                a[k], a[LANES + k] = a[k] * c - a[LANES + k] * s, a[k] * s + a[LANES + k] * c

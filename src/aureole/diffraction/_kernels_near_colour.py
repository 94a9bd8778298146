"""Compiled loops of the near field in colour: powers of many wavelengths added up in X, Y and Z."""

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]


@numba.njit(cache=True, parallel=True)
def add_plane(power: F32, weights: F32, total: F32) -> None:
    """Add the power of one wavelength to a whole plane in colour.

    Parameters
    ----------
    power : ndarray of float32, shape (rows, columns)
        |D|².
    weights : ndarray of float32, shape (3,)
        Of this wavelength for X, Y and Z.
    total : ndarray of float32, shape (rows, columns, 3)
        Added to.
    """
    x, y, z = weights
    for i in numba.prange(len(power)):
        for j in range(power.shape[1]):
            value = power[i, j]
            total[i, j, 0] += x * value
            total[i, j, 1] += y * value
            total[i, j, 2] += z * value

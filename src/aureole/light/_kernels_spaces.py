"""The compiled loop of a change of colour space: plain arrays in, one array filled."""

from typing import Any

from numba import njit, prange
from numpy.typing import NDArray

# Colours that one task of a thread changes.
_BLOCK = 4096


@njit(cache=True, parallel=True, fastmath={"contract"})
def apply(change: NDArray[Any], colours: NDArray[Any], out: NDArray[Any]) -> None:
    """Multiply each colour by a matrix.

    Parameters
    ----------
    change : ndarray, shape (3, 3)
        Target values from source values.
    colours : ndarray, shape (N, 3)
        Of one type with `change` and `out`.
    out : ndarray, shape (N, 3)
        Filled.
    """
    a, b, c = change[0, 0], change[0, 1], change[0, 2]
    d, e, f = change[1, 0], change[1, 1], change[1, 2]
    g, h, k = change[2, 0], change[2, 1], change[2, 2]
    count = len(colours)
    for block in prange((count + _BLOCK - 1) // _BLOCK):
        for i in range(block * _BLOCK, min((block + 1) * _BLOCK, count)):
            x, y, z = colours[i, 0], colours[i, 1], colours[i, 2]
            out[i, 0] = a * x + b * y + c * z
            out[i, 1] = d * x + e * y + f * z
            out[i, 2] = g * x + h * y + k * z

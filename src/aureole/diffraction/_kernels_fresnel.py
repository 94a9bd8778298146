"""Compiled loops of the near field: Fresnel integrals, and tables of them.

E(x) = C(x) + i S(x) = (1 + i) / 2 − w(x) exp(iπx²/2) for x ≥ 0. The factor w is smooth: up to LAST it is
a Taylor polynomial about the nearest of many nodes, beyond that its asymptotic series.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
C128 = NDArray[np.complex128]

# Nodes a unit, and where the asymptotic series takes over.
NODES = 64
LAST = 6.0
# From here on E differs from its limit by less than 1 / (π FLAT).
FLAT = 1e9


@numba.njit(cache=True)
def turned(turns: float) -> tuple[float, float]:
    """Return the cosine and the sine of an angle in turns, to 1e-15."""
    quarters = math.floor(4.0 * turns + 0.5)
    # Whole quarters are taken off exactly; what is left is within an eighth of a turn.
    angle = 2 * math.pi * (turns - 0.25 * quarters)
    q = angle * angle
    sine = q * (-1 / 5040 + q * (1 / 362880 + q * (-1 / 39916800 + q * (1 / 6227020800))))
    sine = angle * (1 + q * (-1 / 6 + q * (1 / 120 + sine)))
    cosine = q * (-1 / 720 + q * (1 / 40320 + q * (-1 / 3628800 + q * (1 / 479001600 - q / 87178291200))))
    cosine = 1 + q * (-0.5 + q * (1 / 24 + cosine))
    turn = int(quarters) & 3
    if turn & 1:
        cosine, sine = sine, cosine
    return (-cosine if turn == 1 or turn == 2 else cosine), (-sine if turn >= 2 else sine)


@numba.njit(cache=True)
def smooth_tail(size: float, taylor: F64) -> tuple[float, float]:
    """Return the real and the imaginary part of w at a place >= 0."""
    if size < LAST:
        node = int(size * NODES + 0.5)
        step = size - node / NODES
        row = taylor[node]
        real, imaginary = row[5], row[11]
        for k in range(4, -1, -1):
            real = real * step + row[k]
            imaginary = imaginary * step + row[6 + k]
        return real, imaginary
    rate = 1.0 / (math.pi * size)
    q = rate / size
    q *= q
    imaginary = rate * (1 - q * (3 - q * (105 - q * (10395 - q * 2027025))))
    real = rate * rate / size * (1 - q * (15 - q * (945 - q * (135135 - q * 34459425))))
    return real, imaginary


@numba.njit(cache=True)
def _integral(x: float, taylor: F64) -> complex:
    """Return C(x) + i S(x)."""
    size = abs(x)
    if size >= FLAT:
        return complex(math.copysign(0.5, x), math.copysign(0.5, x))
    real, imaginary = smooth_tail(size, taylor)
    cosine, sine = turned(0.25 * size * size)
    c = 0.5 - (real * cosine - imaginary * sine)
    s = 0.5 - (real * sine + imaginary * cosine)
    return complex(math.copysign(c, x), math.copysign(s, x))


@numba.njit(cache=True, parallel=True)
def integrals(x: F64, taylor: F64, out: C128) -> None:
    """Fill C(x) + i S(x).

    Parameters
    ----------
    x : ndarray of float64, shape (N,)
        Finite or infinite.
    taylor : ndarray of float64, shape (T, 12)
        Of w about each node: six real parts, six imaginary ones.
    out : ndarray of complex128, shape (N,)
        Filled.
    """
    for k in numba.prange(len(x)):
        out[k] = _integral(x[k], taylor)


@numba.njit(cache=True, parallel=True)
def edge_integrals(edges: F64, places: F64, scale: float, taylor: F64, out: C128) -> None:
    """Fill E(scale (edge − place)) and E(scale (edge + place)).

    Parameters
    ----------
    edges : ndarray of float64, shape (N,)
        Metres.
    places : ndarray of float64, shape (M,)
        Metres.
    scale : float
        √(2 / (λz)), per metre.
    taylor : ndarray of float64, shape (T, 12)
        As for `integrals`.
    out : ndarray of complex128, shape (N, 2, M)
        Filled.
    """
    for k in numba.prange(len(edges)):
        for j in range(len(places)):
            out[k, 0, j] = _integral(scale * (edges[k] - places[j]), taylor)
            out[k, 1, j] = _integral(scale * (edges[k] + places[j]), taylor)


@numba.njit(cache=True, parallel=True)
def interval_factors(table: C128, low: NDArray[np.int64], high: NDArray[np.int64], out: F32) -> None:
    """Fill the even and the odd near field of intervals between two edges.

    Parameters
    ----------
    table : ndarray of complex128, shape (N, 2, M)
        From `edge_integrals`.
    low, high : ndarray of int64, shape (K,)
        Edges at which each interval starts and ends.
    out : ndarray of float32, shape (2, K, 2 M)
        Half the sum and half the difference of an interval's field and its mirror image's: real and
        imaginary parts in turn.
    """
    count = table.shape[2]
    for k in numba.prange(len(low)):
        start, end = table[low[k]], table[high[k]]
        for j in range(count):
            there, back = end[0, j] - start[0, j], end[1, j] - start[1, j]
            even, odd = 0.5 * (there + back), 0.5 * (there - back)
            out[0, k, 2 * j], out[0, k, 2 * j + 1] = even.real, even.imag
            out[1, k, 2 * j], out[1, k, 2 * j + 1] = odd.real, odd.imag

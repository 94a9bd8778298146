"""The corner function as one compiled function of numbers, in float64, for loops over places and edges.

`corner` has the equations. Near the corner g is a polynomial, fitted where h <= s; the other half of the
quadrant follows from g(h, s) + g(s, h) = −i / 2 w(h) w(s). Farther off the series in 1 / ρ² serves.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_fresnel import FLAT, smooth_tail, turned

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

# Where the series takes over, with so many terms; and how the polynomial stretches s.
NEAR, TERMS, STRETCH = 4.5, 9, 0.7


@numba.njit(cache=True)
def corner(h: float, s: float, taylor: F64, table: F64, orders: I64) -> complex:
    """Return the corner function G(h, s), odd in h, h = 0 taken for positive.

    Parameters
    ----------
    h, s : float
        Signed distance of the edge, and where along it the edge starts, in units of √(λz / 2).
    taylor : ndarray
        From `fresnel.taylor_table`.
    table, orders : ndarray
        From `corner.corner_table`.
    """
    size = abs(h)
    cosine, sine = turned(0.25 * (h * h + s * s)) if size + abs(s) < FLAT else (1.0, 0.0)
    real, imag = corner_amplitude(size, abs(s), taylor, table, orders)
    wave = complex(real * cosine - imag * sine, real * sine + imag * cosine)
    if s < 0:
        wave = edge_wave(size, taylor) - wave
    return -wave if h < 0 else wave


@numba.njit(cache=True)
def edge_wave(h: float, taylor: F64) -> complex:
    """Return what a whole straight edge sends to the distance h >= 0: (1 − i) / 2 (E∞ − E(h))."""
    if h >= FLAT:
        return 0j
    real, imag = smooth_tail(h, taylor)
    cosine, sine = turned(0.25 * h * h)
    c, s = real * cosine - imag * sine, real * sine + imag * cosine
    return complex(0.5 * (c + s), 0.5 * (s - c))


@numba.njit(cache=True)
def corner_amplitude(h: float, s: float, taylor: F64, table: F64, orders: I64) -> tuple[float, float]:
    """Return g(h, s), the corner function less its phase exp(iπ(h² + s²) / 2), for h, s >= 0.

    Parameters
    ----------
    h, s, taylor, table, orders
        As of `corner`.
    """
    square = h * h + s * s
    if square >= FLAT * FLAT:
        return 0.0, 0.0
    if square >= NEAR * NEAR:
        return _by_series(h, s, 1.0 / square, taylor)
    real, imag = _by_polynomial(min(h, s), max(h, s), table, orders)
    if h <= s:
        return real, imag
    (a, b), (c, d) = smooth_tail(h, taylor), smooth_tail(s, taylor)
    return 0.5 * (a * d + b * c) - real, 0.5 * (b * d - a * c) - imag


@numba.njit(cache=True)
def _by_series(h: float, s: float, inverse: float, taylor: F64) -> tuple[float, float]:
    """Sum h / (2π) Σ (−1)^k m_k ρ^(−2k−2) with the recurrence of the moments."""
    real, imag = smooth_tail(s, taylor)
    past_real, past_imag = 0.0, 0.0
    turn = s * s * inverse
    step = inverse / math.pi
    total_real, total_imag = real, imag
    # Each moment is carried with its power of −1 / ρ².
    extra = s * step
    for k in range(TERMS):
        odd, even = (2 * k + 1) * step, 2 * k * turn * step
        next_real = turn * real + odd * imag - even * past_imag
        next_imag = turn * imag - odd * real + even * past_real - extra
        past_real, past_imag, real, imag = real, imag, next_real, next_imag
        total_real += real
        total_imag += imag
        extra = 0.0
    scale = h * inverse / (2 * math.pi)
    return scale * total_real, scale * total_imag


@numba.njit(cache=True)
def _by_polynomial(h: float, s: float, table: F64, orders: I64) -> tuple[float, float]:
    """Return g for h <= s <= NEAR."""
    ratio = h / s if s > 0 else 0.0
    first = 1.0 / (1.0 + STRETCH * NEAR)
    x = 2.0 * (1.0 / (1.0 + STRETCH * s) - first) / (1.0 - first) - 1.0
    y = 2.0 * ratio * ratio - 1.0
    real, imag = 0.0, 0.0
    for j in range(len(orders) - 1, -1, -1):
        a, b = 0.0, 0.0
        for k in range(orders[j] - 1, -1, -1):
            a = a * x + table[0, j, k]
            b = b * x + table[1, j, k]
        real, imag = real * y + a, imag * y + b
    return ratio * real, ratio * imag

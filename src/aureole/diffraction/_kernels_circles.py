"""Compiled loops of a circle's near field: a table near its centre, edge waves elsewhere.

Lengths are in Fresnel units, √(λz / 2), so that a path ρ across has the phase πρ²/2.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_fresnel import FLAT, smooth_tail, turned

F64 = NDArray[np.float64]

# A circle as large as this is a straight edge: the wave from its far side is below 1e-9.
STRAIGHT = 1e8
# The table's polynomials are of this degree.
DEGREE = 6


@numba.njit(cache=True)
def _tabulated(r: float, table: NDArray[np.complex128], step: float) -> complex:
    """Return D(r) from the polynomials of D exp(−iπr²/2) about the nearest node."""
    node = int(r / step + 0.5)
    x = r / step - node
    row = table[node]
    value: complex = row[DEGREE]
    for k in range(DEGREE - 1, -1, -1):
        value = value * x + row[k]
    cosine, sine = turned(0.25 * r * r)
    return value * complex(cosine, sine)


@numba.njit(cache=True, error_model="numpy")
def _waves(r: float, radius: float, taylor: F64) -> complex:
    """Return D(r) as that of a straight edge and what the two stationary points of the circle add.

    With c = (R − r) / (R + r), u = √(1 − t) and v = (R + r) / (2√(Rr)), the near point's amplitude
    without the straight edge's is (1 + c) / u − c / (u + v), the far one's (1 + c / (1 − t / v²)) / u.
    Their Taylor coefficients in t times the moments of exp(±i2πRr t) make the two sums.
    """
    h = radius - r
    cosine, sine = turned(0.25 * h * h)
    real, imag = smooth_tail(abs(h), taylor)
    # (1 − i) / 2 times the tail, odd in h
    half = math.copysign(0.5, h)
    near_real, near_imag = half * (real + imag), half * (imag - real)
    shadow = complex(1.0 if h >= 0 else 0.0, 0.0)
    if radius > STRAIGHT:
        return shadow - complex(cosine, sine) * complex(near_real, near_imag)
    across = radius + r
    product = radius * r
    root = math.sqrt(product)
    c = h / across
    p = 2 * root / (2 * root + across)
    e = 1.0 / (4 * math.pi * product)
    lit, square = 1 + c, p * p
    # Powers of i alternate between the two parts.
    even = lit - c * p - 3 * e * e * (0.375 * lit - c * square * (0.125 + 0.25 * p))
    odd = 0.5 * lit - 0.5 * c * square
    odd = e * (odd - 15 * e * e * (0.3125 * lit - c * square * (0.0625 + p * (0.125 + 0.125 * p))))
    scale = 1 / (4 * math.pi * root)
    near_real += scale * (even - odd)
    near_imag += scale * (even + odd)
    m = 4 * product / (across * across)
    even = lit - 3 * e * e * (0.375 * lit + c * m * (0.5 + m))
    odd = e * (0.5 * lit + c * m - 15 * e * e * (0.3125 * lit + c * m * (0.375 + m * (0.5 + m))))
    far_cosine, far_sine = turned(0.25 * across * across)
    far = complex(far_cosine, far_sine) * complex(scale * (even - odd), -scale * (even + odd))
    return shadow - complex(cosine, sine) * complex(near_real, near_imag) - far


@numba.njit(cache=True)
def _disc(r: float, radius: float, table: NDArray[np.complex128], step: float, taylor: F64) -> complex:
    """Return D at a distance r from the centre."""
    if abs(r - radius) >= FLAT:
        return complex(1.0 if r < radius else 0.0, 0.0)
    if r < (len(table) - 0.5) * step:
        return _tabulated(r, table, step)
    return _waves(r, radius, taylor)


@numba.njit(cache=True, parallel=True)
def fill_disc(
    across: tuple[F64, F64],
    radius: float,
    table: NDArray[np.complex128],
    step: float,
    taylor: F64,
    middle: tuple[int, int],
    out: NDArray[np.complex64],
) -> None:
    """Fill the near field of a circular opening.

    Parameters
    ----------
    across : tuple of ndarray of float64
        Distances of the computed rows and of the computed columns from the circle's centre, Fresnel
        units.
    radius : float
        Fresnel units.
    table : ndarray of complex128, shape (T, 7)
        Polynomials of D exp(−iπr²/2) about r = k step, in units of the step.
    step : float
        Fresnel units.
    taylor : ndarray of float64
        Of the Fresnel integrals' smooth part.
    middle : tuple of int
        Row and column through the circle's centre, where only places from there on are computed, else −1.
    out : ndarray of complex64, shape (rows, columns)
        Filled.
    """
    rows, columns = out.shape
    down, along = across
    middle_y, middle_x = middle
    for i in numba.prange(len(down)):
        line = np.empty(len(along), dtype=np.complex64)
        for j in range(len(along)):
            r = math.sqrt(down[i] * down[i] + along[j] * along[j])
            line[j] = _disc(r, radius, table, step, taylor)
        first = max(middle_y, 0)
        for side in range(1 if middle_y < 0 or i == 0 else 2):
            row = first + i if side == 0 else first - i
            if row < 0 or row >= rows:
                continue
            for j in range(columns):
                out[row, j] = line[j if middle_x < 0 else abs(j - middle_x)]

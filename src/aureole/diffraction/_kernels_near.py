"""Compiled loops of the near field of pixels: tables along one axis, and writing the plane in tiles.

E(x) = C(x) + i S(x) = (1 + i) / 2 − w(x) exp(iπx²/2) for x ≥ 0. Here (x + 2) w(x) is one polynomial of
(x − 2) / (x + 2) for every x, so that many places are computed side by side.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

# Where the polynomial's variable is zero, and its degree.
MIDDLE = 2.0
DEGREE = 24
# E has reached its limit.
FARTHEST = 1e9


@numba.njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"})
def line_integrals(start: float, step: float, coefficients: F64, real: F64, imaginary: F64) -> None:
    """Fill C and S at start, start + step, and so on, to 1e-10.

    Parameters
    ----------
    start, step : float
        Finite.
    coefficients : ndarray of float64, shape (2, DEGREE + 1)
        As for `edge_factors`.
    real, imaginary : ndarray of float64, shape (N,)
        Filled.
    """
    for j in range(len(real)):
        x = start + j * step
        size = min(abs(x), FARTHEST)
        inverse = 1.0 / (size + MIDDLE)
        t = (size - MIDDLE) * inverse
        a, b = coefficients[0, DEGREE], coefficients[1, DEGREE]
        for k in range(DEGREE):
            a = a * t + coefficients[0, DEGREE - 1 - k]
            b = b * t + coefficients[1, DEGREE - 1 - k]
        # Whole turns are taken off, and half of what is left is within a quarter of a turn.
        turns = 0.25 * size * size
        angle = math.pi * (turns - math.floor(turns + 0.5))
        q = angle * angle
        sine = 1 / 6227020800 + q * (-1 / 1307674368000 + q * (1 / 355687428096000))
        sine = 1 / 120 + q * (-1 / 5040 + q * (1 / 362880 + q * (-1 / 39916800 + q * sine)))
        sine = angle * (1 + q * (-1 / 6 + q * sine))
        cosine = 1 / 479001600 + q * (-1 / 87178291200 + q * (1 / 20922789888000))
        cosine = 1 / 24 + q * (-1 / 720 + q * (1 / 40320 + q * (-1 / 3628800 + q * cosine)))
        cosine = 1 + q * (-0.5 + q * cosine)
        both, square = 2 * sine * cosine, 1 - 2 * sine * sine
        a, b = a * inverse, b * inverse
        real[j] = math.copysign(0.5 - (a * square - b * both), x)
        imaginary[j] = math.copysign(0.5 - (a * both + b * square), x)


@numba.njit(cache=True, parallel=True)
def edge_factors(
    edges: F64,
    which: NDArray[np.int64],
    first: float,
    step: float,
    count: int,
    coefficients: F64,
    out: F32,
) -> None:
    """Fill the even and the odd near field of the intervals from zero to some of the edges.

    Parameters
    ----------
    edges : ndarray of float64, shape (K,)
        Above zero, times √(2 / (λz)).
    which : ndarray of int64, shape (U,)
        Those that are wanted.
    first, step : float
        Places on the plane, times the same.
    count : int
        How many.
    coefficients : ndarray of float64, shape (2, DEGREE + 1)
        Of the real and the imaginary part of (x + MIDDLE) w(x), powers ascending.
    out : ndarray of float32, shape (2, K, 2 count)
        Filled with half the sum and half the difference of an interval's field and its mirror image's:
        real and imaginary parts in turn.
    """
    zero = np.empty((2, count))
    line_integrals(first, step, coefficients, zero[0], zero[1])
    for index in numba.prange(len(which)):
        k = which[index]
        near, far = np.empty((2, count)), np.empty((2, count))
        line_integrals(edges[k] - first, -step, coefficients, near[0], near[1])
        line_integrals(edges[k] + first, step, coefficients, far[0], far[1])
        even, odd = out[0, k], out[1, k]
        for j in range(count):
            even[2 * j] = 0.5 * (near[0, j] + far[0, j])
            even[2 * j + 1] = 0.5 * (near[1, j] + far[1, j])
            odd[2 * j] = 0.5 * (near[0, j] - far[0, j]) + zero[0, j]
            odd[2 * j + 1] = 0.5 * (near[1, j] - far[1, j]) + zero[1, j]


@numba.njit(cache=True)
def _gather(products: F32, present: NDArray[np.bool_], row: int, parts: F32) -> None:
    """Fill twice the parts of D that are even and odd along x, at a place and at its mirror image along y.

    Even there, odd there, even in the mirror, odd in the mirror; real and imaginary parts in turn.
    """
    parts[:] = 0
    for part in range(4):
        if not present[part]:
            continue
        there, back = parts[part & 1], parts[2 + (part & 1)]
        sign = np.float32(1 - (part & 2))
        along, across = products[part, 2 * row], products[part, 2 * row + 1]
        for j in range(0, len(there), 2):
            # −i (a + ib) (c + id) from ac, ad, bc and bd.
            real, imaginary = along[j + 1] + across[j], across[j + 1] - along[j]
            there[j] += real
            there[j + 1] += imaginary
            back[j] += sign * real
            back[j + 1] += sign * imaginary


@numba.njit(cache=True)
def _write_field(even: F32, odd: F32, first: int, middle: int, out: NDArray[np.complex64]) -> None:
    """Write a row of a tile and its mirror image along x."""
    half, width = np.float32(0.5), len(even) // 2
    target = out[max(middle, 0) + first :]
    for j in range(min(width, len(target))):
        target[j] = complex(half * (even[2 * j] + odd[2 * j]), half * (even[2 * j + 1] + odd[2 * j + 1]))
    for j in range(max(0, 1 - first), min(width, middle - first + 1)):
        # An unsigned index needs no check for counting from the end, which would keep vectors out.
        at = np.uint64(middle - first - j)
        out[at] = complex(half * (even[2 * j] - odd[2 * j]), half * (even[2 * j + 1] - odd[2 * j + 1]))


@numba.njit(cache=True)
def _write_power(even: F32, odd: F32, first: int, middle: int, out: F32) -> None:
    """Write the squares along a row of a tile and its mirror image along x."""
    quarter, width = np.float32(0.25), len(even) // 2
    target = out[max(middle, 0) + first :]
    for j in range(min(width, len(target))):
        real, imaginary = even[2 * j] + odd[2 * j], even[2 * j + 1] + odd[2 * j + 1]
        target[j] = quarter * (real * real + imaginary * imaginary)
    for j in range(max(0, 1 - first), min(width, middle - first + 1)):
        real, imaginary = even[2 * j] - odd[2 * j], even[2 * j + 1] - odd[2 * j + 1]
        out[np.uint64(middle - first - j)] = quarter * (real * real + imaginary * imaginary)


@numba.njit(cache=True, nogil=True)
def write_field(
    products: F32,
    present: NDArray[np.bool_],
    corner: tuple[int, int],
    middle: tuple[int, int],
    out: NDArray[np.complex64],
) -> None:
    """Write the field of a tile, and of its mirror images, into the plane.

    Parameters
    ----------
    products : ndarray of float32, shape (4, 2 H, 2 W)
        Of the parts even, odd along x, odd along y, odd along both: products of the real and imaginary
        parts along y, in turn, with those along x.
    present : ndarray of bool, shape (4,)
        Which parts are not zero.
    corner : tuple of int
        Row and column of the tile's first place, from the middle where the plane is mirrored.
    middle : tuple of int
        Row and column at the plane's origin where the plane is mirrored, else −1.
    out : ndarray of complex64, shape (rows, columns)
        The plane.
    """
    parts = np.empty((4, products.shape[2]), dtype=np.float32)
    for i in range(products.shape[1] // 2):
        _gather(products, present, i, parts)
        row = corner[0] + i
        below = max(middle[0], 0) + row
        if below < len(out):
            _write_field(parts[0], parts[1], corner[1], middle[1], out[below])
        if 0 < row <= middle[0]:
            _write_field(parts[2], parts[3], corner[1], middle[1], out[middle[0] - row])


@numba.njit(cache=True, nogil=True)
def write_power(
    products: F32, present: NDArray[np.bool_], corner: tuple[int, int], middle: tuple[int, int], out: F32
) -> None:
    """Write the squared modulus of a tile's field, and of its mirror images, into the plane.

    Parameters
    ----------
    products : ndarray of float32, shape (4, 2 H, 2 W)
        As for `write_field`.
    present : ndarray of bool, shape (4,)
        As for `write_field`.
    corner, middle : tuple of int
        As for `write_field`.
    out : ndarray of float32, shape (rows, columns)
        The plane.
    """
    parts = np.empty((4, products.shape[2]), dtype=np.float32)
    for i in range(products.shape[1] // 2):
        _gather(products, present, i, parts)
        row = corner[0] + i
        below = max(middle[0], 0) + row
        if below < len(out):
            _write_power(parts[0], parts[1], corner[1], middle[1], out[below])
        if 0 < row <= middle[0]:
            _write_power(parts[2], parts[3], corner[1], middle[1], out[middle[0] - row])


@numba.njit(cache=True)
def _add_row(even: F32, odd: F32, first: int, middle: int, power: F32, field: NDArray[np.complex64]) -> None:
    """Add a row of a tile and its mirror image along x to the field, and square the sums."""
    half, width = np.float32(0.5), len(even) // 2
    start = max(middle, 0) + first
    for j in range(min(width, len(field) - start)):
        at = np.uint64(start + j)
        value = field[at] + complex(
            half * (even[2 * j] + odd[2 * j]), half * (even[2 * j + 1] + odd[2 * j + 1])
        )
        field[at] = value
        power[at] = value.real * value.real + value.imag * value.imag
    for j in range(max(0, 1 - first), min(width, middle - first + 1)):
        at = np.uint64(middle - first - j)
        value = field[at] + complex(
            half * (even[2 * j] - odd[2 * j]), half * (even[2 * j + 1] - odd[2 * j + 1])
        )
        field[at] = value
        power[at] = value.real * value.real + value.imag * value.imag


@numba.njit(cache=True, nogil=True)
def add_field(
    power: F32,
    products: F32,
    present: NDArray[np.bool_],
    corner: tuple[int, int],
    middle: tuple[int, int],
    out: NDArray[np.complex64],
) -> None:
    """Add the field of a tile, and of its mirror images, to the plane, and square the sums.

    Parameters
    ----------
    power : ndarray of float32, shape (rows, columns)
        Filled with the squared modulus where the tile lies.
    products : ndarray of float32, shape (4, 2 H, 2 W)
        As for `write_field`.
    present : ndarray of bool, shape (4,)
        As for `write_field`.
    corner, middle : tuple of int
        As for `write_field`.
    out : ndarray of complex64, shape (rows, columns)
        The plane.
    """
    parts = np.empty((4, products.shape[2]), dtype=np.float32)
    for i in range(products.shape[1] // 2):
        _gather(products, present, i, parts)
        row = corner[0] + i
        below = max(middle[0], 0) + row
        if below < len(out):
            _add_row(parts[0], parts[1], corner[1], middle[1], power[below], out[below])
        if 0 < row <= middle[0]:
            above = middle[0] - row
            _add_row(parts[2], parts[3], corner[1], middle[1], power[above], out[above])

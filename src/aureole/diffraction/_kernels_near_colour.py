"""Compiled loops of the near field in colour: powers of many wavelengths added up in X, Y and Z."""

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]


@numba.njit(cache=True, parallel=True)
def sparse_product(
    starts: NDArray[np.int64], places: NDArray[np.int64], weights: F32, table: F32, out: F32
) -> None:
    """Fill the product of a matrix that is mostly zero with a table.

    Parameters
    ----------
    starts : ndarray of int64, shape (R + 1,)
        Where each row's entries start, and where the last end.
    places : ndarray of int64
        Column of each entry.
    weights : ndarray of float32
        Each entry.
    table : ndarray of float32, shape (h, M)
        Any.
    out : ndarray of float32, shape (R, M)
        Filled.
    """
    for row in numba.prange(len(out)):
        target = out[row]
        target[:] = 0
        for entry in range(starts[row], starts[row + 1]):
            weight, source = weights[entry], table[places[entry]]
            for j in range(len(target)):
                target[j] += weight * source[j]


@numba.njit(cache=True)
def _add_part(products: F32, row: int, sign: np.float32, real: F32, imaginary: F32) -> None:
    """Add a row of a part's field, twice, times i, whose modulus is the same."""
    along, across = products[2 * row], products[2 * row + 1]
    for j in range(len(real)):
        # (a + ib) (c + id) from ac, ad, bc and bd.
        real[j] += sign * (along[2 * j] - across[2 * j + 1])
        imaginary[j] += sign * (along[2 * j + 1] + across[2 * j])


@numba.njit(cache=True)
def _add_power(fields: F32, sign: np.float32, weights: F32, out: F32) -> None:
    """Add the power of a row's even part, with or without its odd one, to its three channels."""
    x, y, z = weights
    first, second, third = out
    for j in range(fields.shape[1]):
        real, imaginary = fields[0, j] + sign * fields[2, j], fields[1, j] + sign * fields[3, j]
        power = real * real + imaginary * imaginary
        first[j] += x * power
        second[j] += y * power
        third[j] += z * power


@numba.njit(cache=True, nogil=True)
def add_tile(
    products: F32, present: NDArray[np.bool_], corner: tuple[int, int], weights: F32, total: F32
) -> None:
    """Add the power of one wavelength on a tile to the quarters of a plane that differ.

    Parameters
    ----------
    products : ndarray of float32, shape (4, 2 H, 2 W)
        Of the parts even, odd along x, odd along y, odd along both: products of the real and imaginary
        parts along y, in turn, with those along x.
    present : ndarray of bool, shape (4,)
        Which parts are not zero.
    corner : tuple of int
        Row and column of the tile's first place among those computed.
    weights : ndarray of float32, shape (3,)
        Of this wavelength for X, Y and Z, times a quarter: the field is half the sum of its parts.
    total : ndarray of float32, shape (V, S, P, 3, Q)
        Added to. V is 1, or 2 where what lies above the middle differs from what lies below; S the same
        for left and right.
    """
    top, first = corner
    rows, columns = products.shape[1] // 2, products.shape[2] // 2
    one = np.float32(1)
    # Even and odd along x; real, then imaginary.
    fields = np.empty((4, columns), np.float32)
    for i in range(rows):
        for side_y in range(len(total)):
            fields[:] = 0
            for part in range(4):
                if present[part]:
                    sign = -one if side_y and part >= 2 else one
                    odd = 2 * (part & 1)
                    _add_part(products[part], i, sign, fields[odd], fields[odd + 1])
            for side_x in range(total.shape[1]):
                target = total[side_y, side_x, top + i, :, first : first + columns]
                _add_power(fields, one - np.float32(2 * side_x), weights, target)


@numba.njit(cache=True, parallel=True)
def unfold_colour(total: F32, middle: tuple[int, int], out: F32) -> None:
    """Fill a plane in colour from its quarters.

    Parameters
    ----------
    total : ndarray of float32, shape (V, S, P, 3, Q)
        As `add_tile` fills it, all tiles.
    middle : tuple of int
        Row and column at the plane's origin, where only places from there on were computed, else −1.
    out : ndarray of float32, shape (rows, columns, 3)
        Filled.
    """
    middle_y, middle_x = middle
    for i in numba.prange(len(out)):
        row = np.int64(i)
        a = row if middle_y < 0 else abs(row - middle_y)
        side_y = 1 if row < middle_y and len(total) == 2 else 0
        for j in range(out.shape[1]):
            b = j if middle_x < 0 else abs(j - middle_x)
            side_x = 1 if j < middle_x and total.shape[1] == 2 else 0
            for channel in range(3):
                out[row, j, channel] = total[side_y, side_x, a, channel, b]


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


@numba.njit(cache=True, parallel=True)
def add_part(field: NDArray[np.complex64], weights: F32, total: F32) -> None:
    """Add the power of one wavelength to a part of a plane in colour.

    Parameters
    ----------
    field : ndarray of complex64, shape (rows, columns)
        D.
    weights : ndarray of float32, shape (3,)
        Of this wavelength for X, Y and Z.
    total : ndarray of float32, shape (rows, 3, columns)
        Added to.
    """
    x, y, z = weights
    for i in numba.prange(len(field)):
        first, second, third = total[i]
        for j in range(field.shape[1]):
            value = field[i, j]
            power = value.real * value.real + value.imag * value.imag
            first[j] += x * power
            second[j] += y * power
            third[j] += z * power

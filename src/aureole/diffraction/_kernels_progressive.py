"""Compiled loops of the progressive far field: find changes, multiply few rows, add, and square.

A change is Σ over parts of left[k, a] · right[k, b], few k: distinct rows of the change, folded about
its centre. Four rows a of the sum at a time, a tile of columns b, stay in the first cache, from where
they are turned to their place, added to the running field and squared, and mirrored to the other half
of the plane. Products are summed over four k at a time, so that the loops are bound by arithmetic.
"""

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
FAST = {"contract", "nsz", "reassoc"}

# Columns of a tile: 513, 1025 and 2049 of them fill whole tiles but for three in a hundred.
TILE = 176
# Rows that are summed together, and products that are added at once.
BLOCK = 4
# The four parts: even or odd along y, even or odd along x.
PARTS = 4
# Where each row's tile of one part begins, and how large the buffer of all is.
PART = BLOCK * TILE
SIZE = PARTS * PART
# Real and imaginary parts right and left of the central column, and the turns of both.
WAVES = 8 * TILE


@numba.njit(parallel=True, cache=True)
def changed_columns(
    old: NDArray[np.int32], new: NDArray[np.int32], first: NDArray[np.int64], last: NDArray[np.int64]
) -> None:
    """Find where the rows of two masks differ by their bits.

    Parameters
    ----------
    old, new : ndarray of int32, shape (rows, columns)
        Bits of the masks.
    first, last : ndarray of int64, shape (rows,)
        Filled with the first column that differs (the number of columns where none does), and the
        first of those after the last one (0 where none does).
    """
    columns = old.shape[1]
    for row in numba.prange(len(old)):
        different = np.int32(0)
        for column in range(columns):
            different |= old[row, column] ^ new[row, column]
        first[row], last[row] = columns, 0
        if different != 0:
            low, high = 0, columns
            while old[row, low] == new[row, low]:
                low += 1
            while old[row, high - 1] == new[row, high - 1]:
                high -= 1
            first[row], last[row] = low, high


@numba.njit(cache=True, fastmath=FAST)
def row_spectra(rows: F32, waves: F32, spectra: F32) -> None:
    """Sum waves with the values of rows that are mostly zero.

    Parameters
    ----------
    rows : ndarray of float32, shape (K, X)
        Values.
    waves : ndarray of float32, shape (X or more, B)
        A wave for each value's place.
    spectra : ndarray of float32, shape (K or more, B or more)
        Filled; the sums are taken in float64, where many equal terms are not rounded alike.
    """
    count = waves.shape[1]
    total = np.empty(count, np.float64)
    for k in range(len(rows)):
        total[:] = 0
        for x in range(rows.shape[1]):
            value = rows[k, x]
            if value != 0:
                wave = waves[x]
                for j in range(count):
                    total[j] += value * wave[j]
        for j in range(count):
            spectra[k, j] = total[j]


@numba.njit(cache=True)
def add_waves(pairs: NDArray[np.int64], waves: F32, sums: F32) -> None:
    """Add up the waves of equal rows.

    Parameters
    ----------
    pairs : ndarray of int64, shape (N, 2)
        A row, and which of the sums is its.
    waves : ndarray of float32, shape (N or more, A)
        A wave for each row.
    sums : ndarray of float32, shape (K, A or more)
        Added to.
    """
    for pair in range(len(pairs)):
        wave, total = waves[pairs[pair, 0]], sums[pairs[pair, 1]]
        for j in range(len(wave)):
            total[j] += wave[j]


@numba.njit(parallel=True, cache=True)
def add_mirrored(
    left: F32, right: F32, starts: NDArray[np.int64], turn_y: F32, turn_x: F32, field: F32, power: F32
) -> None:
    """Add a change to the field on a centred grid, where F(−u, −v) = F*(u, v).

    Parameters
    ----------
    left : ndarray of float32, shape (K, A)
        Factors at the frequencies 0, 1, … of the rows, filled up to whole blocks.
    right : ndarray of float32, shape (K, B)
        Factors at the frequencies 0, 1, … of the columns, filled up to whole tiles.
    starts : ndarray of int64, shape (5,)
        Where the parts begin among the K, each of whole blocks: even along y and x, odd along y,
        odd along x, odd along both.
    turn_y : ndarray of float32, shape (2, rows // 2 + 1)
        Real and imaginary part of what moves the change to its centre, at the frequencies of the rows.
    turn_x : ndarray of float32, shape (2, B)
        The same for the columns.
    field : ndarray of float32, shape (rows, 2 columns)
        Real and imaginary parts in turn; added to.
    power : ndarray of float32, shape (rows, columns)
        Filled with the field's squared modulus.
    """
    many, middle = turn_y.shape[1], power.shape[1] // 2
    tiles = (middle + TILE) // TILE
    for block in numba.prange((many + BLOCK - 1) // BLOCK):
        first = np.int64(block) * BLOCK
        sums, wave = np.empty(tiles * SIZE, np.float32), np.empty(WAVES, np.float32)
        real, imag = np.empty(2 * middle + 1, np.float32), np.empty(2 * middle + 1, np.float32)
        for tile in range(tiles):
            _sum_parts(left, right, starts, first, tile * TILE, sums[tile * SIZE :])
        for row in range(first, min(first + BLOCK, many)):
            for tile in range(tiles):
                low = tile * TILE
                # The rows above the central one have the frequencies 0, −1, ….
                _phases(turn_y[0, row], -turn_y[1, row], turn_x[0, low:], turn_x[1, low:], wave)
                _turn(sums[tile * SIZE + (row - first) * TILE :], wave)
                _place(wave, low, middle, real, imag)
            _add_row(real, imag, row, field, power)


@numba.njit(parallel=True, cache=True)
def add_plain(
    left: F32, right: F32, starts: NDArray[np.int64], turn_y: F32, turn_x: F32, field: F32, power: F32
) -> None:
    """Add a change to the field on any grid; parameters as of `add_mirrored`, a factor a sample."""
    rows, columns = power.shape
    for block in numba.prange((rows + BLOCK - 1) // BLOCK):
        first = np.int64(block) * BLOCK
        sums, wave = np.empty(SIZE, np.float32), np.empty(WAVES, np.float32)
        for low in range(0, columns, TILE):
            _sum_parts(left, right, starts, first, low, sums)
            high = min(low + TILE, columns)
            for row in range(first, min(first + BLOCK, rows)):
                _phases(turn_y[0, row], turn_y[1, row], turn_x[0, low:], turn_x[1, low:], wave)
                _turn_plain(sums[(row - first) * TILE :], wave)
                _add(wave, wave[TILE:], field[row, 2 * low : 2 * high], power[row, low:high])


@numba.njit(cache=True)
def _sum_parts(left: F32, right: F32, starts: NDArray[np.int64], row: np.int64, low: int, sums: F32) -> None:
    """Sum the products of all parts for a block of rows and a tile of columns."""
    sums[:] = 0
    for part in range(PARTS):
        for k in range(starts[part], starts[part + 1], BLOCK):
            _add_products(
                left[k : k + BLOCK, row : row + BLOCK],
                right[k, low : low + TILE],
                right[k + 1, low : low + TILE],
                right[k + 2, low : low + TILE],
                right[k + 3, low : low + TILE],
                sums[part * PART : (part + 1) * PART],
            )


@numba.njit(cache=True, fastmath=FAST)
def _add_products(left: F32, r0: F32, r1: F32, r2: F32, r3: F32, sums: F32) -> None:
    """Add four products to each of four rows."""
    a0, a1, a2, a3 = left[0, 0], left[1, 0], left[2, 0], left[3, 0]
    b0, b1, b2, b3 = left[0, 1], left[1, 1], left[2, 1], left[3, 1]
    c0, c1, c2, c3 = left[0, 2], left[1, 2], left[2, 2], left[3, 2]
    d0, d1, d2, d3 = left[0, 3], left[1, 3], left[2, 3], left[3, 3]
    for j in range(TILE):
        x0, x1, x2, x3 = r0[j], r1[j], r2[j], r3[j]
        sums[j] += a0 * x0 + a1 * x1 + a2 * x2 + a3 * x3
        sums[TILE + j] += b0 * x0 + b1 * x1 + b2 * x2 + b3 * x3
        sums[2 * TILE + j] += c0 * x0 + c1 * x1 + c2 * x2 + c3 * x3
        sums[3 * TILE + j] += d0 * x0 + d1 * x1 + d2 * x2 + d3 * x3


@numba.njit(cache=True, fastmath=FAST)
def _phases(real: np.float32, imag: np.float32, turn_real: F32, turn_imag: F32, wave: F32) -> None:
    """Multiply a row's turn with a tile's, for both signs of the columns' frequencies."""
    for j in range(TILE):
        x, y = turn_real[j], turn_imag[j]
        wave[4 * TILE + j] = real * x - imag * y
        wave[5 * TILE + j] = real * y + imag * x
        wave[6 * TILE + j] = real * x + imag * y
        wave[7 * TILE + j] = imag * x - real * y


@numba.njit(cache=True, fastmath=FAST)
def _turn(sums: F32, wave: F32) -> None:
    """Join a row's four parts and move them to their place, for both signs of the columns' frequencies."""
    for j in range(TILE):
        even, odd_y, odd_x, odd = sums[j], sums[PART + j], sums[2 * PART + j], sums[3 * PART + j]
        x, y = wave[4 * TILE + j], wave[5 * TILE + j]
        wave[j] = (even + odd) * x - (odd_y - odd_x) * y
        wave[TILE + j] = (even + odd) * y + (odd_y - odd_x) * x
        x, y = wave[6 * TILE + j], wave[7 * TILE + j]
        wave[2 * TILE + j] = (even - odd) * x - (odd_y + odd_x) * y
        wave[3 * TILE + j] = (even - odd) * y + (odd_y + odd_x) * x


@numba.njit(cache=True, fastmath=FAST)
def _turn_plain(sums: F32, wave: F32) -> None:
    """Join a row's four parts, and move them to their place."""
    for j in range(TILE):
        real = sums[j] - sums[3 * PART + j]
        imag = -(sums[PART + j] + sums[2 * PART + j])
        x, y = wave[4 * TILE + j], wave[5 * TILE + j]
        wave[j] = real * x - imag * y
        wave[TILE + j] = real * y + imag * x


@numba.njit(cache=True)
def _place(wave: F32, low: int, middle: int, real: F32, imag: F32) -> None:
    """Copy a tile to the right and to the left of a row's central column."""
    count = min(TILE, middle + 1 - low)
    _copy(wave, real[middle + low :], count)
    _copy(wave[TILE:], imag[middle + low :], count)
    _copy_back(wave[2 * TILE :], real[middle - low - count + 1 :], count)
    _copy_back(wave[3 * TILE :], imag[middle - low - count + 1 :], count)


@numba.njit(cache=True)
def _copy(source: F32, target: F32, count: int) -> None:
    for j in range(count):
        target[j] = source[j]


@numba.njit(cache=True)
def _copy_back(source: F32, target: F32, count: int) -> None:
    for j in range(count):
        # An unsigned index needs no check for counting from the end, which would keep vectors out.
        target[j] = source[np.uint64(count - 1 - j)]


@numba.njit(cache=True)
def _add_row(real: F32, imag: F32, row: int, field: F32, power: F32) -> None:
    """Add a row above the central one, and mirror it to the one below."""
    rows, columns = power.shape
    above, below = rows // 2 - row, rows // 2 + row
    _add(real, imag, field[above], power[above])
    if row > 0 and below < rows:
        first = 1 - columns % 2
        _put_back(real[first:], imag[first:], field[below, 2 * first :], power[below, first:])
        if first:
            # At even sizes the first column's frequency has its mirror image beyond the last column.
            imag[columns] *= np.float32(-1)
            _add(real[columns:], imag[columns:], field[below, :2], power[below, :1])


@numba.njit(cache=True, fastmath=FAST)
def _add(real: F32, imag: F32, field: F32, power: F32) -> None:
    """Add a wave to a piece of a row, square the sum, and leave the sum in the wave."""
    for j in range(len(power)):
        x, y = field[2 * j] + real[j], field[2 * j + 1] + imag[j]
        field[2 * j], field[2 * j + 1] = x, y
        real[j], imag[j] = x, y
        power[j] = x * x + y * y


@numba.njit(cache=True, fastmath=FAST)
def _put_back(real: F32, imag: F32, field: F32, power: F32) -> None:
    """Write the conjugate of a wave from its last sample on backward, and its square."""
    last = len(power) - 1
    for j in range(len(power)):
        at = np.uint64(last - j)
        x, y = real[at], imag[at]
        field[2 * j], field[2 * j + 1] = x, -y
        power[j] = x * x + y * y

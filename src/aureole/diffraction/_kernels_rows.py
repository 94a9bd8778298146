"""Compiled loops of the far field by distinct rows: folding a mask, its lines' spectra, the whole plane.

A quadrant is indexed outwards from the mask's centre. The four of them are numbered by parity: 0 is
even along y and x, 1 odd along x, 2 odd along y, 3 odd along both.
"""

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
BLOCK = 32


@numba.njit(cache=True, parallel=True)
def fold(mask: F32, quadrants: F32, sums: NDArray[np.float64], reach: NDArray[np.int64]) -> None:
    """Fold a mask about its centre into its even and odd parts along both axes.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Any.
    quadrants : ndarray of float32, shape (4, h, h)
        Filled; h is (n + 1) // 2. Rows that are zero throughout are left as they were.
    sums : ndarray of float64, shape (4, h)
        Filled with the sum of the magnitudes of each row.
    reach : ndarray of int64, shape (h,)
        Filled with the first column of each row from which on all are zero, or more.
    """
    size, first = len(mask), len(mask) // 2
    for k in numba.prange((size + 1) // 2):
        below, above = mask[first + k], mask[size - 1 - first - k]
        sums[:, k] = _fold_even(below, above, quadrants[0, k])
        for part in range(1, 4):
            if sums[part, k] > 0:
                _fold_odd(below, above, part, quadrants[part, k])
        reach[k] = _reach(quadrants[:, k], sums[:, k])


@numba.njit(cache=True)
def sample(mask: F32, count: int) -> tuple[int, float]:
    """Look at a few rows and columns of a mask's half.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        n at least 2.
    count : int
        How many of each.

    Returns
    -------
    quadrants : int
        How many quadrants of the folded mask hold anything on those rows, 1 to 4.
    share : float
        Share of those rows, or of the columns if it is less, that are lit and unlike the one before.
    """
    size, first = len(mask), len(mask) // 2
    half = (size + 1) // 2
    step = max(1, half // count)
    even = np.empty(half, np.float32)
    odd_x, odd_y, odd = False, False, False
    rows, columns, total = 0, 0, 0
    for k in range(0, half, step):
        sums = _fold_even(mask[first + k], mask[size - 1 - first - k], even)
        odd_x, odd_y, odd = odd_x or bool(sums[1]), odd_y or bool(sums[2]), odd or bool(sums[3])
        last = max(k - step, 0)
        row_differs, column_differs, row_lit, column_lit = k == 0, k == 0, False, False
        for c in range(0, size, max(1, step // 4)):
            row_differs |= mask[first + k, c] != mask[first + last, c]
            column_differs |= mask[c, first + k] != mask[c, first + last]
            row_lit |= mask[first + k, c] != 0
            column_lit |= mask[c, first + k] != 0
        rows += int(row_differs and row_lit)
        columns += int(column_differs and column_lit)
        total += 1
    return 1 + int(odd_x) + int(odd_y) + int(odd), min(rows, columns) / total


@numba.njit(cache=True, fastmath={"reassoc", "nsz"})
def _fold_even(below: F32, above: F32, even: F32) -> tuple[np.float32, ...]:
    """Write one row of the even part and return the sums of the magnitudes of all four."""
    first, last = len(below) // 2, len(below) - 1 - len(below) // 2
    both, odd_x, odd_y, odd = np.float32(0), np.float32(0), np.float32(0), np.float32(0)
    for c in range(len(even)):
        # An unsigned index needs no check for counting from the end, which would keep vectors out.
        right, left = np.uint64(first + c), np.uint64(last - c)
        sum_below, sum_above = below[right] + below[left], above[right] + above[left]
        step_below, step_above = below[right] - below[left], above[right] - above[left]
        value = sum_below + sum_above
        even[c] = value
        both += abs(value)
        odd_x += abs(step_below + step_above)
        odd_y += abs(sum_below - sum_above)
        odd += abs(step_below - step_above)
    return both, odd_x, odd_y, odd


@numba.njit(cache=True)
def _fold_odd(below: F32, above: F32, part: int, out: F32) -> None:
    """Write one row of an odd part."""
    first, last = len(below) // 2, len(below) - 1 - len(below) // 2
    sign_x = np.float32(1 - 2 * (part & 1))
    sign_y = np.float32(1 - (part & 2))
    for c in range(len(out)):
        right, left = np.uint64(first + c), np.uint64(last - c)
        out[c] = (below[right] + sign_x * below[left]) + sign_y * (above[right] + sign_x * above[left])


@numba.njit(cache=True)
def _reach(rows: F32, sums: NDArray[np.float64]) -> int:
    """Return from which column on, to a block, the parts of a row are dark."""
    lit = 0
    for part in range(4):
        if sums[part] > 0:
            high = rows.shape[1]
            while high > lit and _magnitude(rows[part, max(high - BLOCK, 0) : high]) == 0:
                high -= BLOCK
            lit = max(lit, high)
    return lit


@numba.njit(cache=True, fastmath={"reassoc"})
def _magnitude(values: F32) -> float:
    total = np.float32(0)
    for value in values:
        total += abs(value)
    return float(total)


@numba.njit(cache=True)
def _add(target: F32, weight: np.float32, source: F32) -> None:
    for j in range(len(target)):
        target[j] += weight * source[j]


@numba.njit(cache=True)
def hash_lines(
    bits: NDArray[np.uint32], sums: NDArray[np.float64], keys: NDArray[np.uint64]
) -> tuple[NDArray[np.uint64], NDArray[np.uint64]]:
    """Return a number for each row and for each column: equal lines equal numbers, dark ones 0.

    Parameters
    ----------
    bits : ndarray of uint32, shape (h, h)
        A quadrant, its float32 read as bits.
    sums : ndarray of float64, shape (h,)
        Zero where a row is to be taken as dark.
    keys : ndarray of uint64, shape (h,)
        Random odd numbers.

    Returns
    -------
    rows, columns : ndarray of uint64, shape (h,)
        Sums of products with the keys, modulo 2^64.
    """
    half = len(bits)
    rows = np.zeros(half, dtype=np.uint64)
    columns = np.zeros(half, dtype=np.uint64)
    for k in range(half):
        if sums[k] > 0:
            total = np.uint64(0)
            key = keys[k]
            for c in range(half):
                # Trailing zeros of short fractions would weaken the product.
                word = np.uint64(bits[k, c] ^ (bits[k, c] >> np.uint32(15)))
                total += word * keys[c]
                columns[c] += word * key
            rows[k] = total
    return rows, columns


@numba.njit(cache=True)
def count_steps(lines: F32) -> int:
    """Return how many steps up or down the lines have, the one back to zero at their end included.

    Parameters
    ----------
    lines : ndarray of float32, shape (R, h)
        Values.

    Returns
    -------
    int
        Number of steps.
    """
    total = 0
    for row in range(len(lines)):
        line = lines[row]
        for c in range(len(line) - 1):
            total += int(line[c] != line[c + 1])
        total += int(line[-1] != 0)
    return total


@numba.njit(cache=True, parallel=True)
def line_spectra(lines: F32, table: F32) -> F32:
    """Return the spectra of lines from the places where they step.

    Parameters
    ----------
    lines : ndarray of float32, shape (R, h)
        Values.
    table : ndarray of float32, shape (h, M)
        Row k is the spectrum of a line that is one up to and including place k.

    Returns
    -------
    ndarray of float32, shape (R, M)
        One spectrum a line.
    """
    out = np.zeros((len(lines), table.shape[1]), dtype=np.float32)
    for row in numba.prange(len(lines)):
        line = lines[row]
        last = len(line) - 1
        for low in range(0, last, BLOCK):
            high = min(low + BLOCK, last)
            # Most blocks are flat: one test in vectors passes them by.
            if _flat(line[low : high + 1]):
                continue
            for k in range(low, high):
                if line[k] != line[k + 1]:
                    _add(out[row], line[k] - line[k + 1], table[k])
        if line[last] != 0:
            _add(out[row], line[last], table[last])
    return out


@numba.njit(cache=True)
def _flat(values: F32) -> bool:
    steps = 0
    for c in range(len(values) - 1):
        steps += int(values[c] != values[c + 1])
    return steps == 0


@numba.njit(cache=True, parallel=True)
def shared_spectra(places: NDArray[np.int64], starts: NDArray[np.int64], table: F32) -> F32:
    """Return the spectra of sets of places.

    Parameters
    ----------
    places : ndarray of int64
        The sets one after the other, each in ascending order.
    starts : ndarray of int64, shape (R + 1,)
        Where each set starts, and where the last ends.
    table : ndarray of float32, shape (h, M)
        Row k is the spectrum of a line that is one up to and including place k.

    Returns
    -------
    ndarray of float32, shape (R, M)
        One spectrum a set.
    """
    out = np.zeros((len(starts) - 1, table.shape[1]), dtype=np.float32)
    for row in numba.prange(len(starts) - 1):
        low, high = starts[row], starts[row + 1]
        for index in range(low, high):
            # A run of places counts from the edge after its last to the edge before its first.
            k = places[index]
            if index + 1 == high or places[index + 1] != k + 1:
                _add(out[row], np.float32(1), table[k])
            if k > 0 and (index == low or places[index - 1] != k - 1):
                _add(out[row], np.float32(-1), table[k - 1])
    return out


@numba.njit(cache=True)
def parts_of(products: F32, present: NDArray[np.bool_], row: int, scale: np.float32, parts: F32) -> None:
    """Fill F(u, v) and F(−u, v) of one row of frequencies: real, imaginary, real, imaginary part.

    Parameters
    ----------
    products : ndarray of float32, shape (4, P, Q)
        Transforms of the quadrants.
    present : ndarray of bool, shape (4,)
        Which of them hold anything.
    row : int
        Which of the P.
    scale : float32
        Factor.
    parts : ndarray of float32, shape (4, Q)
        Filled.
    """
    parts[:] = 0
    if present[0]:
        _add(parts[0], scale, products[0, row])
        _add(parts[2], scale, products[0, row])
    if present[3]:
        _add(parts[0], -scale, products[3, row])
        _add(parts[2], scale, products[3, row])
    if present[1]:
        _add(parts[1], -scale, products[1, row])
        _add(parts[3], scale, products[1, row])
    if present[2]:
        _add(parts[1], -scale, products[2, row])
        _add(parts[3], -scale, products[2, row])


@numba.njit(cache=True)
def _write(out: NDArray[np.complex64], parts: F32, right: int, sign: np.float32, middle: int) -> None:
    """Write a row of the plane; `right` is the first part that goes right of the middle."""
    real, imaginary = parts[right], parts[right + 1]
    target = out[max(middle, 0) :]
    for j in range(len(target)):
        target[j] = complex(real[j], sign * imaginary[j])
    real, imaginary = parts[2 - right], parts[3 - right]
    for j in range(middle):
        # An unsigned index needs no check for counting from the end, which would keep vectors out.
        at = np.uint64(middle - j)
        out[j] = complex(real[at], sign * imaginary[at])


@numba.njit(cache=True)
def write_both(
    parts: F32, f: int | np.int64, row_zero: int, column_zero: int, out: NDArray[np.complex64]
) -> None:
    """Write the row of a frequency and the one that mirrors it.

    Parameters
    ----------
    parts : ndarray of float32, shape (4, Q)
        F(u, v) and F(−u, v), as `parts_of` fills them.
    f : int
        Which of the frequencies of the rows, from zero upwards, or from the first where the plane is
        not mirrored.
    row_zero, column_zero : int
        As `middle` of `unfold`.
    out : ndarray of complex64, shape (rows, columns)
        The plane.
    """
    row = max(row_zero, 0) + f
    if row < len(out):
        _write(out[row], parts, 0, np.float32(1), column_zero)
    # F(u, −v) is the conjugate of F(−u, v).
    if 0 < f <= row_zero:
        _write(out[row_zero - f], parts, 2, np.float32(-1), column_zero)


@numba.njit(cache=True, parallel=True)
def unfold(
    products: F32,
    present: NDArray[np.bool_],
    scale: np.float32,
    middle: tuple[int, int],
    out: NDArray[np.complex64],
) -> None:
    """Put the plane together from the transforms of the quadrants.

    Parameters
    ----------
    products : ndarray of float32, shape (4, P, Q)
        Cosine or sine transforms of the quadrants along both axes.
    present : ndarray of bool, shape (4,)
        Which of them hold anything.
    scale : float32
        Factor of all values.
    middle : tuple of int
        Row and column of the frequency zero where the products start at zero and the plane is
        mirrored; −1 where the products have the plane's own frequencies.
    out : ndarray of complex64, shape (rows, columns)
        Filled.
    """
    row_zero, column_zero = middle
    for i in numba.prange(products.shape[1]):
        parts = np.empty((4, products.shape[2]), dtype=np.float32)
        parts_of(products, present, i, scale, parts)
        write_both(parts, i, row_zero, column_zero, out)


@numba.njit(cache=True)
def _square(real: F32, imaginary: F32, out: F32) -> None:
    for j in range(len(out)):
        out[j] = real[j] * real[j] + imaginary[j] * imaginary[j]


@numba.njit(cache=True)
def _write_power(out: F32, right: F32, left: F32, middle: int) -> None:
    """Write a row of the plane's power, as `_write`."""
    target = out[max(middle, 0) :]
    for j in range(len(target)):
        target[j] = right[j]
    for j in range(middle):
        out[j] = left[np.uint64(middle - j)]


@numba.njit(cache=True)
def write_powers(right: F32, left: F32, f: int | np.int64, row_zero: int, column_zero: int, out: F32) -> None:
    """Write the power along the row of a frequency and along the one that mirrors it.

    Parameters
    ----------
    right, left : ndarray of float32, shape (Q,)
        The power at (u, v) and at (−u, v).
    f, row_zero, column_zero : int
        As of `write_both`.
    out : ndarray of float32, shape (rows, columns)
        The plane.
    """
    row = max(row_zero, 0) + f
    if row < len(out):
        _write_power(out[row], right, left, column_zero)
    if 0 < f <= row_zero:
        _write_power(out[row_zero - f], left, right, column_zero)


@numba.njit(cache=True, parallel=True)
def unfold_power(
    products: F32, present: NDArray[np.bool_], scale: np.float32, middle: tuple[int, int], out: F32
) -> None:
    """Put the power of the plane together, |F|² without F.

    Parameters
    ----------
    products : ndarray of float32, shape (4, P, Q)
        As for `unfold`.
    present : ndarray of bool, shape (4,)
        As for `unfold`.
    scale : float32
        Factor of the amplitudes.
    middle : tuple of int
        As for `unfold`.
    out : ndarray of float32, shape (rows, columns)
        Filled.
    """
    row_zero, column_zero = middle
    for i in numba.prange(products.shape[1]):
        parts = np.empty((4, products.shape[2]), dtype=np.float32)
        parts_of(products, present, i, scale, parts)
        power = np.empty((2, products.shape[2]), dtype=np.float32)
        for side in range(2):
            _square(parts[2 * side], parts[2 * side + 1], power[side])
        write_powers(power[0], power[1], i, row_zero, column_zero, out)


@numba.njit(cache=True, parallel=True)
def square_field(field: NDArray[np.complex64], out: F32) -> None:
    """Square the modulus of a field.

    Parameters
    ----------
    field : ndarray of complex64, shape (rows, columns)
        Any.
    out : ndarray of float32, shape (rows, columns)
        Filled.
    """
    for i in numba.prange(len(field)):
        for j in range(field.shape[1]):
            value = field[i, j]
            out[i, j] = value.real * value.real + value.imag * value.imag

"""Compiled loops that look a plane's frequencies up in the half spectrum of a real FFT.

A row of the plane falls into runs: frequencies that the half spectrum has, in their order, and others
whose conjugates it has, in the opposite order, by F(−u, −v) = F*(u, v).
"""

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
C64 = NDArray[np.complex64]


@numba.njit(cache=True)
def _copy(line: C64, sign: np.float32, out: C64) -> None:
    for j in range(len(out)):
        out[j] = complex(line[j].real, sign * line[j].imag)


@numba.njit(cache=True)
def _copy_back(line: C64, sign: np.float32, out: C64) -> None:
    last = len(line) - 1
    for j in range(len(out)):
        # An unsigned index needs no check for counting from the end, which would keep vectors out.
        value = line[np.uint64(last - j)]
        out[j] = complex(value.real, sign * value.imag)


@numba.njit(cache=True)
def _look_up(half: C64, row: int, first: int, rows: int, columns: int, out: C64) -> None:
    """Fill a row of the plane from its own row of the half spectrum and from the opposite one."""
    done = 0
    while done < len(out):
        column = (first + done) % columns
        if column < half.shape[1]:
            count = min(half.shape[1] - column, len(out) - done)
            _copy(half[row, column : column + count], np.float32(1), out[done : done + count])
        else:
            count = min(columns - column, len(out) - done)
            line = half[(rows - row) % rows, columns - column - count + 1 : columns - column + 1]
            _copy_back(line, np.float32(-1), out[done : done + count])
        done += count


@numba.njit(cache=True, fastmath={"contract", "nsz"})
def _square(line: C64, weight: np.float32, weights: F32, out: F32) -> None:
    for j in range(len(out)):
        real, imag = line[j].real, line[j].imag
        out[j] = weight * weights[j] * (real * real + imag * imag)


@numba.njit(cache=True, fastmath={"contract", "nsz"})
def _turn(line: C64, turn: np.complex64, turns: C64) -> None:
    for j in range(len(line)):
        line[j] = line[j] * (turn * turns[j])


@numba.njit(cache=True, parallel=True)
def fill_power(
    half: C64, first: tuple[int, int], columns: int, weights_y: F32, weights_x: F32, out: F32
) -> None:
    """Fill a plane with the weighted power of a spectrum.

    Parameters
    ----------
    half : ndarray of complex64, shape (N, M // 2 + 1)
        Half spectrum of a real array of N × M samples, or (N, M) the spectrum of a complex one.
    first : tuple of int
        Frequency (row, column) of the plane's first sample, in steps.
    columns : int
        M.
    weights_y, weights_x : ndarray of float32, shape (rows,) and (columns of the plane,)
        Factors.
    out : ndarray of float32, shape (rows, columns of the plane)
        Filled.
    """
    for i in numba.prange(len(out)):
        line = np.empty(out.shape[1], np.complex64)
        _look_up(half, (first[0] + i) % len(half), first[1], len(half), columns, line)
        _square(line, weights_y[i], weights_x, out[i])


@numba.njit(cache=True, parallel=True)
def fill_field(half: C64, first: tuple[int, int], columns: int, turns_y: C64, turns_x: C64, out: C64) -> None:
    """Fill a plane with a spectrum × turns_y × turns_x; parameters as of `fill_power`."""
    for i in numba.prange(len(out)):
        _look_up(half, (first[0] + i) % len(half), first[1], len(half), columns, out[i])
        _turn(out[i], turns_y[i], turns_x)


@numba.njit(cache=True, parallel=True)
def square(field: C64, weights_y: F32, weights_x: F32, out: F32) -> None:
    """Fill a plane with the weighted power of a field of its shape; parameters as of `fill_power`."""
    for i in numba.prange(len(out)):
        _square(field[i], weights_y[i], weights_x, out[i])

"""Compiled loops of gradient noise: Perlin's improved noise, summed over octaves."""

import math

import numba
import numpy as np
from numpy.typing import NDArray


@numba.njit(cache=True)
def fractal_noise(
    along: NDArray[np.float64],
    across: NDArray[np.float64],
    depths: NDArray[np.float64],
    offsets: NDArray[np.float64],
    table: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Sum octaves of gradient noise, each twice as fine and half as strong as the one before.

    Parameters
    ----------
    along, across : ndarray, shape (rows, 2), (columns, 2)
        What each row and each column adds to a pixel's two coordinates, in cells of the first octave.
    depths : ndarray, shape (octaves,)
        Third coordinate in each octave.
    offsets : ndarray, shape (octaves, 2)
        Where each octave starts, lest their lattices meet.
    table : ndarray of int64, shape (n,)
        A permutation of 0..n − 1, n a power of two.

    Returns
    -------
    ndarray, shape (rows, columns)
        About −1..1, mean near zero.
    """
    rows, columns = len(along), len(across)
    total = np.empty((rows, columns))
    for row in range(rows):
        for column in range(columns):
            x = along[row, 0] + across[column, 0]
            y = along[row, 1] + across[column, 1]
            value, strength, frequency = 0.0, 1.0, 1.0
            for octave in range(len(depths)):
                at_x = x * frequency + offsets[octave, 0]
                at_y = y * frequency + offsets[octave, 1]
                value += strength * _noise(at_x, at_y, depths[octave], table)
                strength *= 0.5
                frequency *= 2.0
            total[row, column] = value
    return total


@numba.njit(cache=True)
def _noise(x: float, y: float, z: float, table: NDArray[np.int64]) -> float:
    """Return Perlin's improved noise at a point (Perlin 2002)."""
    left, top, front = math.floor(x), math.floor(y), math.floor(z)
    x, y, z = x - left, y - top, z - front
    value = 0.0
    # Each corner of the cell adds its slope, weighted by how near it is.
    for k in range(2):
        weight_z = _ease(z) if k else 1.0 - _ease(z)
        for j in range(2):
            weight_y = _ease(y) if j else 1.0 - _ease(y)
            for i in range(2):
                weight_x = _ease(x) if i else 1.0 - _ease(x)
                corner = _corner(left + i, top + j, front + k, table)
                value += weight_x * weight_y * weight_z * _slope(corner, x - i, y - j, z - k)
    return value


@numba.njit(cache=True)
def _ease(t: float) -> float:
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


@numba.njit(cache=True)
def _corner(i: int, j: int, k: int, table: NDArray[np.int64]) -> int:
    """Return the permuted number of a corner of the lattice."""
    last = len(table) - 1
    return int(table[(table[(table[i & last] + j) & last] + k) & last])


@numba.njit(cache=True)
def _slope(corner: int, x: float, y: float, z: float) -> float:
    """Return the product with one of the twelve directions to a cube's edges, four of them twice."""
    which = corner & 15
    u = x if which < 8 else y
    v = y if which < 4 else (x if which in (12, 14) else z)
    return (u if which & 1 == 0 else -u) + (v if which & 2 == 0 else -v)

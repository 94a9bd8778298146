"""Compiled loops of the quadtree: one level of merging at a time."""

import numba
import numpy as np
from numpy.typing import NDArray


@numba.njit(cache=True, parallel=True)
def merge_level(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Merge squares of 2 × 2 values into one level up, listing what the upper value leaves over.

    Parameters
    ----------
    values : ndarray, shape (2 n, 2 n)
        Values of one level.

    Returns
    -------
    upper : ndarray, shape (n, n)
        Values of the next level.
    listed : ndarray, shape (N, 5)
        x0, y0, x1, y1 in units of this level's squares, and the signed weight.
    """
    size = len(values) // 2
    upper = np.empty((size, size))
    starts = np.zeros(size + 1, dtype=np.int64)
    for row in numba.prange(size):
        total = 0
        for column in range(size):
            block = _block(values, row, column)
            upper[row, column] = _value_above(block)
            total += _count(block, upper[row, column])
        starts[row + 1] = total
    starts = np.cumsum(starts)
    listed = np.empty((starts[-1], 5))
    for row in numba.prange(size):
        index = starts[row]
        column = 0
        while index < starts[row + 1]:
            block = _block(values, row, column)
            index = _list(block, upper[row, column], 2 * column, 2 * row, listed, index)
            column += 1
    return upper, listed


@numba.njit(cache=True)
def _block(values: NDArray[np.float64], row: int, column: int) -> tuple[float, float, float, float]:
    return (
        values[2 * row, 2 * column],
        values[2 * row, 2 * column + 1],
        values[2 * row + 1, 2 * column],
        values[2 * row + 1, 2 * column + 1],
    )


@numba.njit(cache=True)
def _value_above(block: tuple[float, float, float, float]) -> float:
    """Return the value that leaves the fewest rectangles: dark first, then the darkest."""
    a, b, c, d = block
    if a == b and a == c and a == d:
        return a
    best, fewest = 0.0, _count(block, 0.0)
    for value in block:
        count = _count(block, value)
        if count < fewest or (count == fewest and value < best):
            best, fewest = value, count
    return best


@numba.njit(cache=True)
def _count(block: tuple[float, float, float, float], value: float) -> int:
    """Return how many rectangles it takes to make a block from a flat value."""
    a, b, c, d = block
    lit = int(a != value) + int(b != value) + int(c != value) + int(d != value)
    across = int(a == b and a != value) + int(c == d and c != value)
    down = int(a == c and a != value) + int(b == d and b != value)
    return lit - max(across, down)


@numba.njit(cache=True)
def _list(
    block: tuple[float, float, float, float],
    value: float,
    x: int,
    y: int,
    listed: NDArray[np.float64],
    index: int,
) -> int:
    """Append a block's rectangles, adjacent equals as one of 2:1."""
    a, b, c, d = block
    across = int(a == b and a != value) + int(c == d and c != value)
    down = int(a == c and a != value) + int(b == d and b != value)
    if across >= down:
        index = _list_pair(a, b, value, x, y, 1, 0, listed, index)
        return _list_pair(c, d, value, x, y + 1, 1, 0, listed, index)
    index = _list_pair(a, c, value, x, y, 0, 1, listed, index)
    return _list_pair(b, d, value, x + 1, y, 0, 1, listed, index)


@numba.njit(cache=True)
def _list_pair(
    first: float,
    second: float,
    value: float,
    x: int,
    y: int,
    dx: int,
    dy: int,
    listed: NDArray[np.float64],
    index: int,
) -> int:
    if first == second:
        if first != value:
            _write(listed, index, x, y, x + 1 + dx, y + 1 + dy, first - value)
            index += 1
        return index
    if first != value:
        _write(listed, index, x, y, x + 1, y + 1, first - value)
        index += 1
    if second != value:
        _write(listed, index, x + dx, y + dy, x + dx + 1, y + dy + 1, second - value)
        index += 1
    return index


@numba.njit(cache=True)
def _write(
    listed: NDArray[np.float64], index: int, x0: int, y0: int, x1: int, y1: int, weight: float
) -> None:
    listed[index, 0] = x0
    listed[index, 1] = y0
    listed[index, 2] = x1
    listed[index, 3] = y1
    listed[index, 4] = weight

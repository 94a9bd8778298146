"""Compiled merging of a sheet's cells, 2×2 blocks at a time: the published test and the correct one.

A block is named by its first cell; `sizes` holds the exponent of its size there, -1 where nothing begins.
"""

import math
from typing import Any, TypeAlias

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
I8 = NDArray[np.int8]
Flags = NDArray[np.bool_]
Four: TypeAlias = tuple[float, float, float, float]
Nine: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]
ZERO: Any = np.float32(0)
QUARTER: Any = np.float32(0.25)
HALF: Any = np.float32(0.5)
ONE: Any = np.float32(1)
TWO: Any = np.float32(2)
THREE: Any = np.float32(3)
NINE: Any = np.float32(9)
HUGE: Any = np.float32(1e9)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def merge_published(x: F32, y: F32, steps: int, units: F32, bound: float, sizes: I8, whole: Flags) -> None:
    """Merge blocks of 2×2 by Eq. 12 as printed.

    Parameters
    ----------
    x, y : ndarray of float32, shape (W, rows, columns)
        Pixels.
    steps : int
        Largest exponent of a size.
    units : ndarray of float32, shape (2,)
        Normalised device coordinates a pixel, along x and y.
    bound : float
        The paper's gamma.
    sizes : ndarray of int8, shape (W, rows - 1, columns - 1)
        Changed where blocks merge.
    whole : ndarray of bool, shape (W, rows - 1, columns - 1)
        Whether a cell may merge.
    """
    for w in range(sizes.shape[0]):
        for step in range(1, steps + 1):
            n = 1 << (step - 1)
            for i in range(0, sizes.shape[1] - 2 * n + 1, 2 * n):
                for j in range(0, sizes.shape[2] - 2 * n + 1, 2 * n):
                    if not four_alike(sizes[w], whole[w], i, j, n, step - 1):
                        continue
                    alike = True
                    for pair in range(4):
                        # Left and right, above and below: a neighbour follows its block by (down, right).
                        down, far = pair & 1, n * (pair >> 1)
                        a, b = (i, j + far) if down else (i + far, j)
                        alike &= edges_alike(x[w], y[w], a, b, down * n, (1 - down) * n, n, units, bound)
                    if alike:
                        join(sizes[w], i, j, n)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def edges_alike(
    x: F32, y: F32, i: int, j: int, down: int, right: int, n: int, units: F32, bound: float
) -> bool:
    """Return whether each edge of a block is like that of its neighbour by Eq. 12, signs and all."""
    for edge in range(4):
        # Top and bottom along the row, left and right down the column.
        upright, far = edge & 1, n * (edge >> 1)
        a, b = (i, j + far) if upright else (i + far, j)
        c, d = (a + n, b) if upright else (a, b + n)
        ex = x[c, d] - x[a, b] - x[c + down, d + right] + x[a + down, b + right]
        ey = y[c, d] - y[a, b] - y[c + down, d + right] + y[a + down, b + right]
        if not ex * units[0] + ey * units[1] < bound:
            return False
    return True


@numba.njit(cache=True, nogil=True, error_model="numpy")
def four_alike(sizes: I8, whole: Flags, i: int, j: int, n: int, exponent: int) -> bool:
    """Return whether the four children of a block have one size and may merge."""
    for child in range(4):
        a, b = i + n * (child >> 1), j + n * (child & 1)
        if sizes[a, b] != exponent or not whole[a, b]:
            return False
    return True


@numba.njit(cache=True, nogil=True, error_model="numpy")
def join(sizes: I8, i: int, j: int, n: int) -> None:
    """Make one block of four: the first child takes its name."""
    sizes[i, j] += 1
    sizes[i, j + n] = sizes[i + n, j] = sizes[i + n, j + n] = -1


@numba.njit(cache=True, nogil=True, error_model="numpy")
def merge_correct(
    x: F32,
    y: F32,
    rays: tuple[F32, F32, F32, F32],
    steps: int,
    position: float,
    brightness: float,
    sizes: I8,
    whole: Flags,
    power: F32,
) -> None:
    """Merge blocks of 2×2 where that moves nothing and changes no brightness by more than is allowed.

    Parameters
    ----------
    x, y : ndarray of float32, shape (W, rows, columns)
        Pixels.
    rays : tuple of ndarray of float32, each of shape (W, rows, columns)
        Weight, level, stop_x and stop_y as a sheet's.
    steps : int
        Largest exponent of a size.
    position : float
        Largest distance, in pixels, by which a point of a block, or of an iris's edge in it, may move.
    brightness : float
        Largest relative change of brightness; not heeded in blocks within a pixel.
    sizes : ndarray of int8, shape (W, rows - 1, columns - 1)
        Changed where blocks merge.
    whole : ndarray of bool, shape (W, rows - 1, columns - 1)
        Whether a cell may merge.
    power : ndarray of float32, shape (W, rows - 1, columns - 1)
        Filled with the blocks' sums of their cells' mean weights.
    """
    moved, changed = np.empty(sizes.shape[1:], np.float32), np.empty(sizes.shape[1:], np.float32)
    for w in range(sizes.shape[0]):
        u, v, weight, stop_x, stop_y = x[w], y[w], rays[0][w], rays[2][w], rays[3][w]
        size, done = sizes[w], power[w]
        start(weight, done, moved, changed)
        for step in range(1, steps + 1):
            n = 1 << (step - 1)
            for i in range(0, size.shape[0] - 2 * n + 1, 2 * n):
                for j in range(0, size.shape[1] - 2 * n + 1, 2 * n):
                    if not four_alike(size, whole[w], i, j, n, step - 1):
                        continue
                    px, py, light = nodes(u, i, j, n), nodes(v, i, j, n), nodes(weight, i, j, n)
                    iris = nodes(stop_x, i, j, n), nodes(stop_y, i, j, n)
                    powers = quarters(done, i, j, n)
                    # Two bilinear maps of a child differ most at a node, so that the steps' bounds add up.
                    shift = worst(quarters(moved, i, j, n)) + movement(px, py, iris[0], iris[1])
                    change = worst(quarters(changed, i, j, n)) + brightness_change(px, py, light, powers)
                    # Within a pixel only the power counts, but no block goes over a fold.
                    small = change < HUGE and span(px, py) < TWO
                    if shift <= position and (change <= brightness or small):
                        join(size, i, j, n)
                        moved[i, j], changed[i, j] = shift, min(change, brightness)
                        done[i, j] = powers[0] + powers[1] + powers[2] + powers[3]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def start(weight: F32, power: F32, moved: F32, changed: F32) -> None:
    """Fill what is known of single cells: the mean weight, and that nothing has moved or changed."""
    for i in range(power.shape[0]):
        for j in range(power.shape[1]):
            pair = weight[i, j] + weight[i, j + 1]
            power[i, j] = QUARTER * (pair + weight[i + 1, j] + weight[i + 1, j + 1])
            moved[i, j] = changed[i, j] = ZERO


@numba.njit(cache=True, nogil=True, error_model="numpy")
def nodes(values: F32, i: int, j: int, n: int) -> Nine:
    """Return a block's nine nodes, row by row."""
    m = 2 * n
    a, b, c = values[i, j], values[i, j + n], values[i, j + m]
    d, e, f = values[i + n, j], values[i + n, j + n], values[i + n, j + m]
    return a, b, c, d, e, f, values[i + m, j], values[i + m, j + n], values[i + m, j + m]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def quarters(values: F32, i: int, j: int, n: int) -> Four:
    """Return what is stored of a block's four children, around the block."""
    return values[i, j], values[i, j + n], values[i + n, j + n], values[i + n, j]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def worst(values: Four) -> float:
    """Return the largest of four numbers."""
    largest: float = max(max(values[0], values[1]), max(values[2], values[3]))
    return largest


@numba.njit(cache=True, nogil=True, error_model="numpy")
def bend(p: Nine, q: Nine) -> float:
    """Return how far, at most, the inner nodes lie off the corners' bilinear map."""
    a, b = p[1] - HALF * (p[0] + p[2]), q[1] - HALF * (q[0] + q[2])
    c, d = p[3] - HALF * (p[0] + p[6]), q[3] - HALF * (q[0] + q[6])
    e, f = p[5] - HALF * (p[2] + p[8]), q[5] - HALF * (q[2] + q[8])
    g, h = p[7] - HALF * (p[6] + p[8]), q[7] - HALF * (q[6] + q[8])
    k, m = p[4] - QUARTER * (p[0] + p[2] + p[6] + p[8]), q[4] - QUARTER * (q[0] + q[2] + q[6] + q[8])
    edges = worst((a * a + b * b, c * c + d * d, e * e + f * f, g * g + h * h))
    return math.sqrt(max(edges, k * k + m * m))


@numba.njit(cache=True, nogil=True, error_model="numpy")
def span(p: Nine, q: Nine) -> float:
    """Return the sum of a block's diagonals."""
    a, b, c, d = p[8] - p[0], q[8] - q[0], p[6] - p[2], q[6] - q[2]
    return math.sqrt(a * a + b * b) + math.sqrt(c * c + d * d)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def movement(x: Nine, y: Nine, stop_x: Nine, stop_y: Nine) -> float:
    """Return by how many pixels a merged block moves its nodes, or the stop's places on them."""
    wide = span(stop_x, stop_y)
    iris: float = bend(stop_x, stop_y) * span(x, y) / wide if wide > ZERO else ZERO
    return max(bend(x, y), iris)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def cross(ax: float, ay: float, bx: float, by: float) -> float:
    """Return a × b."""
    return ax * by - ay * bx


@numba.njit(cache=True, nogil=True, error_model="numpy")
def brightness_change(x: Nine, y: Nine, weight: Nine, power: Four) -> float:
    """Return the largest relative change of a child's mean brightness by its parent; huge at a fold.

    Power is conserved, so the parent's is the children's; on its map each of them gets the part that the
    corners' weights say, on the part of the area that the corners' places say.
    """
    a = cross(x[2] - x[0], y[2] - y[0], x[6] - x[0], y[6] - y[0])
    b = cross(x[8] - x[2], y[8] - y[2], x[0] - x[2], y[0] - y[2])
    c = cross(x[6] - x[8], y[6] - y[8], x[2] - x[8], y[2] - y[8])
    d = cross(x[0] - x[6], y[0] - y[6], x[8] - x[6], y[8] - y[6])
    folded: float = HUGE
    if not (min(min(a, b), min(c, d)) > ZERO or max(max(a, b), max(c, d)) < ZERO):
        return folded
    p, q, r, s = weight[0], weight[2], weight[8], weight[6]
    ratio = TWO * (power[0] + power[1] + power[2] + power[3]) / (p + q + r + s)
    # A child's area is half the cross product of its diagonals.
    first = ratio * cross(x[4] - x[0], y[4] - y[0], x[3] - x[1], y[3] - y[1]) / power[0]
    second = ratio * cross(x[5] - x[1], y[5] - y[1], x[4] - x[2], y[4] - y[2]) / power[1]
    third = ratio * cross(x[8] - x[4], y[8] - y[4], x[7] - x[5], y[7] - y[5]) / power[2]
    fourth = ratio * cross(x[7] - x[3], y[7] - y[3], x[6] - x[4], y[6] - y[4]) / power[3]
    return worst(
        (
            quarter_change(first, p, q + s, r, a, b + d, c),
            quarter_change(second, q, r + p, s, b, c + a, d),
            quarter_change(third, r, s + q, p, c, d + b, a),
            quarter_change(fourth, s, p + r, q, d, a + c, b),
        )
    )


@numba.njit(cache=True, nogil=True, error_model="numpy")
def quarter_change(ratio: float, p: float, q: float, r: float, a: float, b: float, c: float) -> float:
    """Return how a child's brightness changes.

    Its own corner, the sum of the two beside it, and the one across: of weights p, q, r and of areas a, b, c.
    """
    # A bilinear number's mean over a quarter has 9, 3, 1, 3 parts of the corners.
    change: float = abs(ratio * (NINE * p + THREE * q + r) / (NINE * a + THREE * b + c) - ONE)
    if change >= ONE:
        change = HUGE
    return change

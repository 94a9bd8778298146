"""Compiled loops of culling: brightness along lines, tiles that it crosses, tiles of the plane."""

import numba
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]


@numba.njit(cache=True, parallel=True, fastmath={"reassoc"})
def line_sums(lines: F32, weights: F32) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the weighted sum of each line, and how many places it takes up to its last light.

    Parameters
    ----------
    lines : ndarray of float32, shape (R, h)
        Values.
    weights : ndarray of float32, shape (h,)
        Of the places.

    Returns
    -------
    sums : ndarray of float64, shape (R,)
        Sums.
    lengths : ndarray of int64, shape (R,)
        Places.
    """
    sums = np.empty(len(lines))
    lengths = np.empty(len(lines), dtype=np.int64)
    for row in numba.prange(len(lines)):
        line = lines[row]
        total = np.float32(0)
        for k in range(len(line)):
            total += line[k] * weights[k]
        last = len(line)
        while last > 0 and line[last - 1] == 0:
            last -= 1
        sums[row], lengths[row] = total, last
    return sums, lengths


@numba.njit(cache=True, parallel=True)
def line_brightness(
    products: F32, slopes: F32, present: NDArray[np.bool_], centre: float, rate: float, mirrored: bool
) -> F32:
    """Return |F|² + |∂F|² / κ² along lines of the plane, ∂ across the line.

    Parameters
    ----------
    products, slopes : ndarray of float32, shape (4, N, M)
        The quadrants' transforms on N lines, and their derivatives across the lines. Of the parities
        the first is the one across the lines.
    present : ndarray of bool, shape (4,)
        Which quadrants hold anything.
    centre : float
        2π times the middle of what is lit, across the lines: its phase is no fringe.
    rate : float
        The fringe rate κ.
    mirrored : bool
        Whether F on the mirrored lines counts, too.

    Returns
    -------
    ndarray of float32, shape (N, M)
        The brighter of both where `mirrored`.
    """
    _, lines, samples = products.shape
    out = np.empty((lines, samples), dtype=np.float32)
    middle, weight = np.float32(centre), np.float32(1 / rate**2)
    for line in numba.prange(lines):
        value = np.zeros((4, samples), dtype=np.float32)
        slope = np.zeros((4, samples), dtype=np.float32)
        for part in range(4):
            if present[part]:
                value[part] = products[part, line]
                slope[part] = slopes[part, line]
        for j in range(samples):
            bright = np.float32(0)
            for side in range(2 if mirrored else 1):
                sign = np.float32(1 - 2 * side)
                real = value[0, j] - sign * value[3, j]
                imaginary = -sign * value[1, j] - value[2, j]
                along = slope[0, j] - sign * slope[3, j] - middle * imaginary
                across = -sign * slope[1, j] - slope[2, j] + middle * real
                found = real * real + imaginary * imaginary + weight * (along * along + across * across)
                bright = max(bright, found)
            out[line, j] = bright
    return out


@numba.njit(cache=True)
def mark_tiles(
    brightness: F32, lines: NDArray[np.int64], stride: int, level: float, lit: NDArray[np.bool_]
) -> None:
    """Mark the tiles on either side of each place where a line is bright.

    Parameters
    ----------
    brightness : ndarray of float32, shape (N + 1, M)
        Along the tiles' edges, at every `stride`-th frequency.
    lines : ndarray of int64, shape (K + 1,)
        Where the edges that cross the lines stand.
    stride : int
        Frequencies from sample to sample.
    level : float
        What counts as bright.
    lit : ndarray of bool, shape (N, K)
        Set to true where a tile is to be lit; else left.
    """
    for line in range(len(brightness)):
        for tile in range(lit.shape[1]):
            # Samples one stride beyond either end of the edge count for it.
            low = max(0, (lines[tile] + stride - 1) // stride - 1)
            high = min(brightness.shape[1], lines[tile + 1] // stride + 2)
            bright = False
            for j in range(low, high):
                bright |= brightness[line, j] > level
            if bright:
                if line > 0:
                    lit[line - 1, tile] = True
                if line < len(lit):
                    lit[line, tile] = True


@numba.njit(cache=True, nogil=True)
def write_tile(
    products: F32,
    present: NDArray[np.bool_],
    scale: np.float32,
    corner: tuple[int, int],
    middle: tuple[int, int],
    out: F32,
) -> None:
    """Write the power of a tile, and of its mirror images, into the plane.

    Parameters
    ----------
    products : ndarray of float32, shape (4, H, W)
        Transforms of the quadrants on the tile.
    present : ndarray of bool, shape (4,)
        Which of them hold anything.
    scale : float32
        Factor of the power.
    corner : tuple of int
        Row and column of the tile's first frequency, from zero where the plane is mirrored.
    middle : tuple of int
        Row and column of the frequency zero where the plane is mirrored, else −1.
    out : ndarray of float32, shape (rows, columns)
        The plane.
    """
    _, height, width = products.shape
    power = np.empty((2, width), dtype=np.float32)
    dark = np.zeros(width, dtype=np.float32)
    for i in range(height):
        a = products[0, i] if present[0] else dark
        b = products[1, i] if present[1] else dark
        c = products[2, i] if present[2] else dark
        d = products[3, i] if present[3] else dark
        for j in range(width):
            power[0, j] = scale * ((a[j] - d[j]) ** 2 + (b[j] + c[j]) ** 2)
            power[1, j] = scale * ((a[j] + d[j]) ** 2 + (b[j] - c[j]) ** 2)
        row = corner[0] + i
        below = max(middle[0], 0) + row
        if below < len(out):
            _write_row(out[below], power, 0, corner[1], middle[1])
        # |F(u, −v)| is |F(−u, v)|.
        if 0 < row <= middle[0]:
            _write_row(out[middle[0] - row], power, 1, corner[1], middle[1])


@numba.njit(cache=True)
def _write_row(out: F32, power: F32, right: int, first: int, middle: int) -> None:
    start = max(middle, 0) + first
    for j in range(min(power.shape[1], len(out) - start)):
        out[start + j] = power[right, j]
    for j in range(max(0, 1 - first), min(power.shape[1], middle - first + 1)):
        out[middle - first - j] = power[1 - right, j]

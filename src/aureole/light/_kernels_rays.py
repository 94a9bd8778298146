"""The loops of the spectral sum along rays: onto rays, the weights along them, and back to a grid.

A fan is a bundle of rays from the origin: ray k crosses line i (i samples from the origin) at
slope_k × i samples to the side. Lines are a pattern's rows, or its columns. Around each line stand `FRAME`
zeros.
"""

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

FRAME = 4
_BLOCK = 16  # lines of the output that one thread fills before the next


@njit(cache=True, fastmath={"contract"}, inline="always")
def _catmull_rom(a, b, c, d, t):  # type: ignore[no-untyped-def]
    """Evaluate the cubic through b and c whose slopes there are (c − a)/2 and (d − b)/2."""
    bend = np.float32(3.0) * (b - c) + d - a
    bow = a + a - np.float32(5.0) * b + np.float32(4.0) * c - d
    return b + np.float32(0.5) * t * ((c - a) + t * (bow + t * bend))


@njit(cache=True, parallel=True)
def frame_lines(image: NDArray[np.float32], by_columns: bool, framed: NDArray[np.float32]) -> None:
    """Copy the last rows or columns of an image into framed lines (L, ·), the first of them first."""
    count, length = framed.shape[0], framed.shape[1] - 2 * FRAME
    first = (image.shape[1] if by_columns else image.shape[0]) - count
    for block in prange((count + _BLOCK - 1) // _BLOCK):
        low, high = block * _BLOCK, min(count, (block + 1) * _BLOCK)
        framed[low:high, :FRAME] = np.float32(0.0)
        framed[low:high, FRAME + length :] = np.float32(0.0)
        if by_columns:
            for j in range(length):
                for i in range(low, high):
                    framed[i, FRAME + j] = image[j, first + i]
        else:
            for i in range(low, high):
                for j in range(length):
                    framed[i, FRAME + j] = image[first + i, j]


@njit(cache=True, nogil=True, fastmath={"contract"})
def cross_lines(
    lines: NDArray[np.float32], origin: int, slopes: NDArray[np.float32], taps: int, fan: NDArray[np.float32]
) -> None:
    """Fill fan (L, K) with framed lines (L, ·), interpolated where K rays cross them.

    The origin is the framed index of the sample on the axis. Taps are 2 (linear) or 4 (cubic).
    """
    count, rays = fan.shape
    low, high = np.float32(1.0), np.float32(lines.shape[1] - 3)
    for i in range(count):
        line = lines[i]
        for k in range(rays):
            place = min(max(slopes[k] * np.float32(i) + np.float32(origin), low), high)
            index = np.uint32(place)
            t = place - np.float32(index)
            b, c = line[index], line[index + np.uint32(1)]
            if taps == 2:
                fan[i, k] = b + (c - b) * t
            else:
                a, d = line[index - np.uint32(1)], line[index + np.uint32(2)]
                fan[i, k] = max(_catmull_rom(a, b, c, d, t), np.float32(0.0))


@njit(cache=True, nogil=True)
def weigh_lines(
    nodes: NDArray[np.float64],
    ratios: NDArray[np.float64],
    weights: NDArray[np.float64],
    taps: int,
    first: int,
    table: NDArray[np.float64],
) -> None:
    """Add to table (N, 3, L) how much of lines first, first + 1, ... goes into each of N nodes along a ray.

    Wavelengths of weights (W, 3) look at ratio × node and share it among 2 or 4 lines. A line before the
    origin counts for its mirror image.
    """
    reach = first + table.shape[2]
    for n in range(nodes.size):
        for k in range(ratios.size):
            place = ratios[k] * nodes[n]
            index = int(place)
            t = place - index
            shares = (0.0, 1.0 - t, t, 0.0)
            if taps == 4:
                shares = (
                    0.5 * t * (t * (2.0 - t) - 1.0),
                    0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
                    0.5 * t * (t * (4.0 - 3.0 * t) + 1.0),
                    0.5 * t * t * (t - 1.0),
                )
            for tap in range(4):
                line = abs(index + tap - 1)
                if first <= line < reach:
                    for channel in range(3):
                        table[n, channel, line - first] += weights[k, channel] * shares[tap]


@njit(cache=True, parallel=True, fastmath={"contract"})
def leave_rays(
    fans: NDArray[np.float32],
    nodes: NDArray[np.int64],
    shares: NDArray[np.float32],
    lines: NDArray[np.float32],
    across: NDArray[np.float32],
    starts: NDArray[np.int64],
    stops: NDArray[np.int64],
    symmetric: bool,
    by_columns: bool,
    out: NDArray[np.float32],
) -> None:
    """Fill the pixels of out that lie in two opposite fans, from their sums along rays.

    Parameters
    ----------
    fans : ndarray of float32, shape (1 or 2, N, 3, K)
        Sums at N nodes along K rays of slopes −1 to 1, the last one twice; the second for lines before
        the origin. Where `symmetric`, one serves both.
    nodes, shares : ndarray, shape (R, 4)
        The nodes between which each line lies and their interpolation weights.
    lines : ndarray of float32, shape (R,)
        Positions of the output's lines, in samples from the origin.
    across : ndarray of float32, shape (C,)
        Positions along a line, rising.
    starts, stops : ndarray of int64, shape (R,)
        Which of the positions along each line lie in the fans.
    symmetric : bool
        Whether one fan serves both.
    by_columns : bool
        Whether the lines are the output's columns.
    out : ndarray of float32, shape (R, C, 3), or (C, R, 3) by columns
        Filled from start to stop in each line.
    """
    rays = fans.shape[3]
    half = np.float32((rays - 2) // 2)
    last = rays - 2
    for block in prange((lines.size + _BLOCK - 1) // _BLOCK):
        blended = np.empty((3, rays), np.float32)
        for i in range(block * _BLOCK, min(lines.size, (block + 1) * _BLOCK)):
            line = lines[i]
            start, stop = starts[i], stops[i]
            if start >= stop:
                continue
            fan = fans[1] if line < 0 and not symmetric else fans[0]
            scale = half / line if line != 0 else np.float32(0.0)
            ends = across[start] * scale + half, across[stop - 1] * scale + half
            low = max(int(min(ends)) - 1, 0)
            high = min(int(max(ends)) + 3, rays)
            n0, n1, n2, n3 = nodes[i]
            s0, s1, s2, s3 = shares[i]
            for channel in range(3):
                f0, f1, f2, f3 = fan[n0, channel], fan[n1, channel], fan[n2, channel], fan[n3, channel]
                total = blended[channel]
                for k in range(low, high):
                    total[k] = (s0 * f0[k] + s1 * f1[k]) + (s2 * f2[k] + s3 * f3[k])
            for j in range(start, stop):
                place = min(max(across[j] * scale + half, np.float32(0.0)), np.float32(last))
                index = np.uint32(place)
                t = place - np.float32(index)
                for channel in range(3):
                    value = blended[channel, index]
                    value += (blended[channel, index + np.uint32(1)] - value) * t
                    if by_columns:
                        out[j, i, channel] = max(value, np.float32(0.0))
                    else:
                        out[i, j, channel] = max(value, np.float32(0.0))

"""Compiled loops of the coherence sum: pairs of edges at every pixel."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

# Differences over a smaller step than this, in fringes, are taken as slopes.
SMALLEST = 0.05


@numba.njit(parallel=True, cache=True)
def add_pairs(
    u: NDArray[np.float64],
    v: NDArray[np.float64],
    vertices: NDArray[np.float64],
    following: NDArray[np.int64],
    weights: NDArray[np.float64],
    pairs: NDArray[np.float32],
    own: NDArray[np.float32],
    shared: NDArray[np.float32],
    total: NDArray[np.float64],
    steps: int,
    out: NDArray[np.float32],
) -> None:
    """Write Σ_jk κ_j κ_k ⟨E_j, E_k⟩ / (16π⁴ |q|⁴) at every frequency.

    Parameters
    ----------
    u, v : ndarray, shapes (C,) and (R,)
        Frequencies of columns and rows, cycles per unit of length.
    vertices : ndarray, shape (V, 2)
        Corners.
    following : ndarray, shape (V,)
        Index of each corner's next.
    weights : ndarray, shape (V,)
        Signed transmittance of the ring of each edge.
    pairs : ndarray, shape (V, V, T, 3)
        Γ of each pair of corners.
    own, shared : ndarray, shape (V, T, 3)
        A and B of each edge.
    total : ndarray, shape (3,)
        Γ(0).
    steps : int
        Table entries per fringe.
    out : ndarray, shape (R, C, 3)
        Written.
    """
    count = len(vertices)
    for row in numba.prange(len(v)):
        kappa = np.empty(count)
        along = np.empty(count)
        phase = np.empty(count)
        values = np.zeros(3)
        for column in range(len(u)):
            for j in range(count):
                ex = vertices[following[j], 0] - vertices[j, 0]
                ey = vertices[following[j], 1] - vertices[j, 1]
                phase[j] = u[column] * vertices[j, 0] + v[row] * vertices[j, 1]
                along[j] = u[column] * ex + v[row] * ey
                kappa[j] = (u[column] * ey - v[row] * ex) * weights[j]
            values[:] = 0.0
            for j in range(count):
                _add_own(kappa[j], along[j], own[j], total, steps, values)
                for k in range(j):
                    factor = 2 * kappa[j] * kappa[k]
                    if following[k] == j:
                        _add_adjacent(
                            k, j, factor, along, following, phase, pairs, shared, total, steps, values
                        )
                    elif following[j] == k:
                        _add_adjacent(
                            j, k, factor, along, following, phase, pairs, shared, total, steps, values
                        )
                    else:
                        _add_apart(j, k, factor, along, following, phase, pairs, steps, values)
            square = u[column] * u[column] + v[row] * v[row]
            scale = 1 / (16 * math.pi**4 * square * square) if square > 0 else 0.0
            for channel in range(3):
                out[row, column, channel] = max(values[channel] * scale, 0.0)


@numba.njit(cache=True)
def _add_own(
    kappa: float,
    x: float,
    own: NDArray[np.float32],
    total: NDArray[np.float64],
    steps: int,
    values: NDArray[np.float64],
) -> None:
    """Add an edge with itself, κ² A(x), A → 2 Γ(0) / x² beyond the table."""
    square = kappa * kappa
    if abs(x) * steps < len(own) - 4:
        _look_up(own, abs(x), steps, square, values)
    else:
        for channel in range(3):
            values[channel] += square * 2 * total[channel] / (x * x)


@numba.njit(cache=True)
def _add_adjacent(
    j: int,
    k: int,
    factor: float,
    along: NDArray[np.float64],
    following: NDArray[np.int64],
    phase: NDArray[np.float64],
    pairs: NDArray[np.float32],
    shared: NDArray[np.float32],
    total: NDArray[np.float64],
    steps: int,
    values: NDArray[np.float64],
) -> None:
    """Add edge j with its next, k: −B(x) / y + (Γ(y) − Γ(x + y)) / (x y), x the smaller of the two."""
    x, y, near, sign = along[j], along[k], j, -1.0
    if abs(x) > abs(y):
        x, y, near = y, x, k
    if y == 0:
        return
    if abs(x) * steps < shared.shape[1] - 4:
        turned = sign if x >= 0 else -sign
        _look_up(shared[near], abs(x), steps, factor * turned / y, values)
    else:
        for channel in range(3):
            values[channel] -= factor * total[channel] / (x * y)
    # What is left is coherent over the longer of the two only.
    step = x if abs(x) > SMALLEST else math.copysign(SMALLEST, x)
    far = (k, following[k]) if near == j else (j, k)
    _look_up_pair(pairs, far[0], far[1], y, steps, factor / (step * y), values)
    _look_up_pair(pairs, j, following[k], y + step, steps, -factor / (step * y), values)


@numba.njit(cache=True)
def _add_apart(
    j: int,
    k: int,
    factor: float,
    along: NDArray[np.float64],
    following: NDArray[np.int64],
    phase: NDArray[np.float64],
    pairs: NDArray[np.float32],
    steps: int,
    values: NDArray[np.float64],
) -> None:
    """Add two edges without a common corner: (Γ(a) − Γ(b) − Γ(c) + Γ(d)) / (x_j x_k)."""
    a = phase[j] - phase[k]
    reach = (pairs.shape[2] - 4) / steps
    if abs(a) - abs(along[j]) - abs(along[k]) > reach:
        return
    x = along[j] if abs(along[j]) > SMALLEST else math.copysign(SMALLEST, along[j])
    y = along[k] if abs(along[k]) > SMALLEST else math.copysign(SMALLEST, along[k])
    share = factor / (x * y)
    _look_up_pair(pairs, j, k, a, steps, share, values)
    _look_up_pair(pairs, j, following[k], a - y, steps, -share, values)
    _look_up_pair(pairs, following[j], k, a + x, steps, -share, values)
    _look_up_pair(pairs, following[j], following[k], a + x - y, steps, share, values)


@numba.njit(cache=True)
def _look_up_pair(
    pairs: NDArray[np.float32],
    m: int,
    n: int,
    s: float,
    steps: int,
    factor: float,
    values: NDArray[np.float64],
) -> None:
    if abs(s) * steps < pairs.shape[2] - 4:
        _look_up(pairs[m, n], abs(s), steps, factor, values)


@numba.njit(cache=True)
def _look_up(
    table: NDArray[np.float32], s: float, steps: int, factor: float, values: NDArray[np.float64]
) -> None:
    """Add a factor times a table's value between its entries, by Catmull-Rom's cubic."""
    place = s * steps
    index = int(place)
    t = place - index
    # The table's first entry lies one step before zero.
    w0 = t * (-0.5 + t * (1 - 0.5 * t))
    w1 = 1 + t * t * (-2.5 + 1.5 * t)
    w2 = t * (0.5 + t * (2 - 1.5 * t))
    w3 = t * t * (-0.5 + 0.5 * t)
    for channel in range(3):
        values[channel] += factor * (
            w0 * table[index, channel]
            + w1 * table[index + 1, channel]
            + w2 * table[index + 2, channel]
            + w3 * table[index + 3, channel]
        )

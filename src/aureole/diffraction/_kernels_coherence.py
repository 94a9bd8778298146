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
    limits: NDArray[np.float64],
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
    limits : ndarray, shape (V,)
        |q·e| of each edge below which its streak is near and pairs of edges are summed one by one.
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
    count, columns = len(vertices), len(u)
    for row in numba.prange(len(v)):
        tau = np.zeros((count, columns))
        near = np.zeros(columns, dtype=np.bool_)
        sums = np.zeros((3, columns))
        _corner_weights(u, v[row], vertices, following, weights, limits, tau, near)
        for m in range(count):
            for column in range(columns):
                square = tau[m, column] * tau[m, column]
                sums[0, column] += square * total[0]
                sums[1, column] += square * total[1]
                sums[2, column] += square * total[2]
            for n in range(m):
                _add_corners(
                    u, v[row], vertices[m] - vertices[n], tau[m], tau[n], near, pairs[m, n], steps, sums
                )
        values = np.zeros(3)
        work = np.zeros((3, count))
        for column in range(columns):
            if near[column]:
                _pair_by_pair(
                    u[column],
                    v[row],
                    vertices,
                    following,
                    weights,
                    pairs,
                    own,
                    shared,
                    total,
                    steps,
                    work,
                    values,
                )
                sums[0, column], sums[1, column], sums[2, column] = values[0], values[1], values[2]
            square = u[column] * u[column] + v[row] * v[row]
            scale = 1 / (16 * math.pi**4 * square * square) if square > 0 else 0.0
            for channel in range(3):
                out[row, column, channel] = max(sums[channel, column] * scale, 0.0)


@numba.njit(cache=True, error_model="numpy")
def _corner_weights(
    u: NDArray[np.float64],
    v: float,
    vertices: NDArray[np.float64],
    following: NDArray[np.int64],
    weights: NDArray[np.float64],
    limits: NDArray[np.float64],
    tau: NDArray[np.float64],
    near: NDArray[np.bool_],
) -> None:
    """Write τ_m = κ_m / x_m − κ_{m−1} / x_{m−1} along a row, and where an edge's streak is near."""
    for j in range(len(vertices)):
        k = following[j]
        ex, ey = vertices[k, 0] - vertices[j, 0], vertices[k, 1] - vertices[j, 1]
        along_v, cross_v, limit = v * ey, v * ex, limits[j]
        for column in range(len(u)):
            along = u[column] * ex + along_v
            close = abs(along) < limit
            near[column] |= close
            quotient = (u[column] * ey - cross_v) * weights[j] / (1.0 if close else along)
            tau[j, column] += quotient
            tau[k, column] -= quotient


@numba.njit(cache=True)
def _add_corners(
    u: NDArray[np.float64],
    v: float,
    difference: NDArray[np.float64],
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    near: NDArray[np.bool_],
    table: NDArray[np.float32],
    steps: int,
    sums: NDArray[np.float64],
) -> None:
    """Add 2 τ_m τ_n Γ(q·(v_m − v_n)) in the columns where Γ lives."""
    reach = (len(table) - 4) / steps
    low, high = _columns_within(u, difference[0], v * difference[1], reach)
    for column in range(low, high):
        s = abs(u[column] * difference[0] + v * difference[1])
        if s >= reach or near[column]:
            continue
        place = s * steps
        index = int(place)
        t = place - index
        w0 = t * (-0.5 + t * (1 - 0.5 * t))
        w1 = 1 + t * t * (-2.5 + 1.5 * t)
        w2 = t * (0.5 + t * (2 - 1.5 * t))
        w3 = t * t * (-0.5 + 0.5 * t)
        factor = 2 * first[column] * second[column]
        for channel in range(3):
            sums[channel, column] += factor * (
                w0 * table[index, channel]
                + w1 * table[index + 1, channel]
                + w2 * table[index + 2, channel]
                + w3 * table[index + 3, channel]
            )


@numba.njit(cache=True)
def _columns_within(u: NDArray[np.float64], dx: float, along_v: float, reach: float) -> tuple[int, int]:
    """Return the range of columns in which |u dx + along_v| can be below a reach."""
    count = len(u)
    if count == 1 or dx == 0:
        return (0, count) if count == 1 or abs(along_v) < reach else (0, 0)
    step = u[1] - u[0]
    one = ((reach - along_v) / dx - u[0]) / step
    other = ((-reach - along_v) / dx - u[0]) / step
    low = min(max(min(one, other) - 1, 0.0), float(count))
    high = min(max(max(one, other) + 2, 0.0), float(count))
    return int(low), int(high)


@numba.njit(cache=True)
def _pair_by_pair(
    u: float,
    v: float,
    vertices: NDArray[np.float64],
    following: NDArray[np.int64],
    weights: NDArray[np.float64],
    pairs: NDArray[np.float32],
    own: NDArray[np.float32],
    shared: NDArray[np.float32],
    total: NDArray[np.float64],
    steps: int,
    work: NDArray[np.float64],
    values: NDArray[np.float64],
) -> None:
    """Sum the pairs of edges at one frequency, regular where q is normal to an edge."""
    count = len(vertices)
    kappa, along, phase = work[0], work[1], work[2]
    for j in range(count):
        ex = vertices[following[j], 0] - vertices[j, 0]
        ey = vertices[following[j], 1] - vertices[j, 1]
        phase[j] = u * vertices[j, 0] + v * vertices[j, 1]
        along[j] = u * ex + v * ey
        kappa[j] = (u * ey - v * ex) * weights[j]
    values[:] = 0.0
    for j in range(count):
        _add_own(kappa[j], along[j], own[j], total, steps, values)
        for k in range(j):
            factor = 2 * kappa[j] * kappa[k]
            if following[k] == j:
                _add_adjacent(k, j, factor, along, following, pairs, shared, total, steps, values)
            elif following[j] == k:
                _add_adjacent(j, k, factor, along, following, pairs, shared, total, steps, values)
            else:
                _add_apart(j, k, factor, along, following, phase, pairs, steps, values)


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

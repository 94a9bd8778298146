"""Compiled loops of the coherence sum where the streak of an edge is near, and look-ups in its tables.

A table (T, 4) holds the channels side by side, the fourth unused, so that a look-up reads neighbouring
numbers. Its first entry lies one step before zero and two lie beyond its last, for Lagrange's cubic
through four entries. Positions are unsigned, because signed ones cost a check for wrap-around a look-up.
"""

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

# Differences over a smaller step than this, in fringes, are taken as slopes; over a step below SHORT both
# ends share the mean of their tables, lest their pixels' factors be divided by next to nothing.
SMALLEST, SHORT = 0.05, 0.5


class Corners(NamedTuple):
    """The corners of an opening and the edges that begin at them.

    Parameters
    ----------
    vertices : ndarray, shape (V, 2)
        Corners.
    following : ndarray, shape (V,)
        Index of each corner's next.
    weights : ndarray, shape (V,)
        Signed transmittance of the ring of each edge.
    limits : ndarray, shape (V,)
        |q·e| of each edge below which its streak is near.
    widths : ndarray, shape (V,)
        Mean square of q·e over a pixel or a disc about its centre, of each edge.
    """

    vertices: NDArray[np.float64]
    following: NDArray[np.int64]
    weights: NDArray[np.float64]
    limits: NDArray[np.float64]
    widths: NDArray[np.float64]


class Tables(NamedTuple):
    """What is looked up.

    Parameters
    ----------
    pairs : ndarray, shape (V (V − 1) / 2, T, 4)
        Γ of the corners m > n at place m (m − 1) / 2 + n.
    reaches : ndarray, shape (V (V − 1) / 2,)
        |q·(v_m − v_n)| beyond which Γ counts as zero.
    counts, lengths, starts, phases : ndarray
        As `lay_out_phases` leaves them.
    own, shared : ndarray, shape (V, T, 4)
        A and B of each edge.
    total : ndarray, shape (3,)
        Γ(0).
    steps : int
        Entries per fringe.
    """

    pairs: NDArray[np.float32]
    reaches: NDArray[np.float64]
    counts: NDArray[np.int64]
    lengths: NDArray[np.int64]
    starts: NDArray[np.int64]
    phases: NDArray[np.float32]
    own: NDArray[np.float32]
    shared: NDArray[np.float32]
    total: NDArray[np.float64]
    steps: int


@numba.njit(cache=True, error_model="numpy")
def add_near_streaks(
    u: NDArray[np.float64],
    v: float,
    corners: Corners,
    tables: Tables,
    near: NDArray[np.int64],
    tau: NDArray[np.float32],
    sums: NDArray[np.float32],
) -> None:
    """Add the edges whose streaks are near, each with itself, with the other corners and with each other.

    Parameters
    ----------
    u : ndarray, shape (C,)
        Frequencies of the columns.
    v : float
        That of the row.
    corners : Corners
        Of the opening.
    tables : Tables
        What is looked up.
    near : ndarray, shape (V, 2)
        First column near each edge's streak, and the one after the last.
    tau : ndarray, shape (V, C)
        What the other edges leave at each corner.
    sums : ndarray, shape (C, 4)
        Added to.
    """
    vertices, following, weights = corners.vertices, corners.following, corners.weights
    for j in range(len(vertices)):
        low, high = near[j]
        if low >= high:
            continue
        k = following[j]
        _add_near_edge(
            u, v, vertices[j], vertices[k], weights[j], corners.widths[j], low, high, tau[j], tau[k],
            tables.own[j], tables.shared[j], tables.total, tables.steps, sums,
        )  # fmt: skip
        _add_edge_with_corners(
            u, v, vertices, j, k, weights[j], low, high, tau, tables.pairs, tables.reaches, tables.steps, sums
        )
        for i in range(j):
            first, after = max(low, near[i, 0]), min(high, near[i, 1])
            _add_near_edges(
                u, v, vertices, following, weights, j, i, first, after, tables.pairs, tables.shared,
                tables.total, tables.steps, sums,
            )  # fmt: skip


@numba.njit(cache=True, inline="always")
def cubic(table, place, factor, line):  # type: ignore[no-untyped-def]
    """Add a factor times a table's values at a place in steps to a line's four channels."""
    index = np.uint32(place)
    t = np.float32(place - index)
    before, after, beyond = t + np.float32(1), t - np.float32(1), t - np.float32(2)
    w0 = factor * np.float32(-1 / 6) * t * after * beyond
    w1 = factor * np.float32(0.5) * before * after * beyond
    w2 = factor * np.float32(-0.5) * before * t * beyond
    w3 = factor * np.float32(1 / 6) * before * t * after
    a, b = table[index], table[index + np.uint32(1)]
    c, d = table[index + np.uint32(2)], table[index + np.uint32(3)]
    x = w0 * a[0] + w1 * b[0] + w2 * c[0] + w3 * d[0]
    y = w0 * a[1] + w1 * b[1] + w2 * c[1] + w3 * d[1]
    z = w0 * a[2] + w1 * b[2] + w2 * c[2] + w3 * d[2]
    w = w0 * a[3] + w1 * b[3] + w2 * c[3] + w3 * d[3]
    line[0] += x
    line[1] += y
    line[2] += z
    line[3] += w


@numba.njit(cache=True)
def look_up(
    table: NDArray[np.float32], s: float, steps: int, factor: float, line: NDArray[np.float32]
) -> None:
    """Add a factor times an even table's value; it is zero beyond its end."""
    place = abs(s) * steps
    if place < table.shape[0] - 4:
        cubic(table, place, np.float32(factor), line)


@numba.njit(cache=True)
def columns_within(u: NDArray[np.float64], dx: float, along_v: float, reach: float) -> tuple[int, int]:
    """Return the range of columns in which |u dx + along_v| is below a reach."""
    count = len(u)
    step = u[1] - u[0] if count > 1 else 1.0
    if abs(dx) * step * count < 1e-9 * reach:
        return (0, count) if abs(u[0] * dx + along_v) < reach else (0, 0)
    one = ((reach - along_v) / dx - u[0]) / step
    other = ((-reach - along_v) / dx - u[0]) / step
    low = min(max(math.ceil(min(one, other)), 0.0), float(count))
    high = min(max(math.floor(max(one, other)) + 1, low), float(count))
    return int(low), int(high)


@numba.njit(cache=True, error_model="numpy")
def _add_near_edge(
    u: NDArray[np.float64],
    v: float,
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    weight: float,
    width: float,
    low: int,
    high: int,
    at_start: NDArray[np.float32],
    at_end: NDArray[np.float32],
    own: NDArray[np.float32],
    shared: NDArray[np.float32],
    total: NDArray[np.float64],
    steps: int,
    sums: NDArray[np.float32],
) -> None:
    """Add a near edge with itself, κ² A(x), and with what else its corners carry, 2 κ B(x) (τ_j − τ_k)."""
    ex, ey = end[0] - start[0], end[1] - start[1]
    last = float(own.shape[0] - 4)
    for column in range(low, high):
        x = u[column] * ex + v * ey
        kappa = (u[column] * ey - v * ex) * weight
        square, cross = kappa * kappa, 2 * kappa * (at_start[column] - at_end[column])
        if x < 0:
            cross = -cross
        place = abs(x) * steps
        if place < last:
            cubic(own, place, np.float32(square), sums[column])
            cubic(shared, place, np.float32(cross), sums[column])
        else:
            # Beyond the tables A → 2 Γ(0) ⟨1 / x²⟩ and B → Γ(0) ⟨1 / x⟩.
            ratio = width / (x * x)
            factor = 2 * square * (1 + 3 * ratio) / (x * x) + cross * (1 + ratio) / abs(x)
            for channel in range(3):
                sums[column, channel] += factor * total[channel]


@numba.njit(cache=True, error_model="numpy")
def _add_edge_with_corners(
    u: NDArray[np.float64],
    v: float,
    vertices: NDArray[np.float64],
    j: int,
    k: int,
    weight: float,
    low: int,
    high: int,
    tau: NDArray[np.float32],
    pairs: NDArray[np.float32],
    reaches: NDArray[np.float64],
    steps: int,
    sums: NDArray[np.float32],
) -> None:
    """Add 2 κ τ_m (Γ(q·(v_j − v_m)) − Γ(q·(v_k − v_m))) / x for a near edge and the other corners."""
    ex, ey = vertices[k, 0] - vertices[j, 0], vertices[k, 1] - vertices[j, 1]
    for m in range(len(vertices)):
        if m in (j, k):
            continue
        one, other = _pair(j, m), _pair(k, m)
        mx = (vertices[j, 0] + vertices[k, 0]) / 2 - vertices[m, 0]
        my = v * ((vertices[j, 1] + vertices[k, 1]) / 2 - vertices[m, 1])
        # The ends of the edge are at half its own |q·e| from its middle.
        widest = max(abs(u[low] * ex + v * ey), abs(u[high - 1] * ex + v * ey), SMALLEST)
        first, after = columns_within(u, mx, my, max(reaches[one], reaches[other]) + widest / 2)
        for column in range(max(low, first), min(high, after)):
            x = u[column] * ex + v * ey
            kappa = (u[column] * ey - v * ex) * weight
            middle, factor = u[column] * mx + my, 2 * kappa * tau[m, column]
            _add_difference(pairs[one], pairs[other], middle - x / 2, x, steps, factor, sums[column])


@numba.njit(cache=True, error_model="numpy")
def _add_difference(
    one: NDArray[np.float32],
    other: NDArray[np.float32],
    s: float,
    x: float,
    steps: int,
    factor: float,
    line: NDArray[np.float32],
) -> None:
    """Add a factor times (Γ_one(s) − Γ_other(s + x)) / x."""
    if abs(x) >= SHORT:
        look_up(one, s, steps, factor / x, line)
        look_up(other, s + x, steps, -factor / x, line)
        return
    step = x if abs(x) > SMALLEST else math.copysign(SMALLEST, x)
    first = s + (x - step) / 2
    for table in (one, other):
        look_up(table, first, steps, factor / (2 * step), line)
        look_up(table, first + step, steps, -factor / (2 * step), line)


@numba.njit(cache=True)
def _pair(m: int, n: int) -> int:
    """Return the place of a pair of corners in the tables."""
    return m * (m - 1) // 2 + n if m > n else n * (n - 1) // 2 + m


@numba.njit(cache=True, error_model="numpy")
def _add_near_edges(
    u: NDArray[np.float64],
    v: float,
    vertices: NDArray[np.float64],
    following: NDArray[np.int64],
    weights: NDArray[np.float64],
    j: int,
    k: int,
    low: int,
    high: int,
    pairs: NDArray[np.float32],
    shared: NDArray[np.float32],
    total: NDArray[np.float64],
    steps: int,
    sums: NDArray[np.float32],
) -> None:
    """Add 2 κ_j κ_k ⟨E_j, E_k⟩ where the streaks of both edges are near."""
    next_j, next_k = following[j], following[k]
    ax, ay = vertices[next_j, 0] - vertices[j, 0], vertices[next_j, 1] - vertices[j, 1]
    bx, by = vertices[next_k, 0] - vertices[k, 0], vertices[next_k, 1] - vertices[k, 1]
    cx, cy = vertices[j, 0] - vertices[k, 0], vertices[j, 1] - vertices[k, 1]
    for column in range(low, high):
        q = u[column]
        x, y, apart = q * ax + v * ay, q * bx + v * by, q * cx + v * cy
        factor = 2 * (q * ay - v * ax) * (q * by - v * bx) * weights[j] * weights[k]
        if next_k == j:
            _add_adjacent(k, j, next_j, y, x, factor, pairs, shared, total, steps, sums[column])
        elif next_j == k:
            _add_adjacent(j, k, next_k, x, y, factor, pairs, shared, total, steps, sums[column])
        else:
            _add_apart(j, next_j, k, next_k, x, y, apart, factor, pairs, steps, sums[column])


@numba.njit(cache=True, error_model="numpy")
def _add_adjacent(
    first: int,
    corner: int,
    last: int,
    x: float,
    y: float,
    factor: float,
    pairs: NDArray[np.float32],
    shared: NDArray[np.float32],
    total: NDArray[np.float64],
    steps: int,
    line: NDArray[np.float32],
) -> None:
    """Add an edge with its next, k: −B(x) / y + (Γ(y) − Γ(x + y)) / (x y), x the smaller of the two."""
    edge, one = first, _pair(corner, last)
    if abs(x) > abs(y):
        x, y, edge, one = y, x, corner, _pair(first, corner)
    if y == 0:
        return
    if abs(x) * steps < shared.shape[1] - 4:
        look_up(shared[edge], x, steps, (-factor if x >= 0 else factor) / y, line)
    else:
        for channel in range(3):
            line[channel] -= factor * total[channel] / (x * y)
    # What is left is coherent over the longer of the two only.
    _add_difference(pairs[one], pairs[_pair(first, last)], y, x, steps, factor / y, line)


@numba.njit(cache=True, error_model="numpy")
def _add_apart(
    j: int,
    after_j: int,
    k: int,
    after_k: int,
    x: float,
    y: float,
    apart: float,
    factor: float,
    pairs: NDArray[np.float32],
    steps: int,
    line: NDArray[np.float32],
) -> None:
    """Add two edges without a common corner: (Γ(a) − Γ(b) − Γ(c) + Γ(d)) / (x_j x_k)."""
    wide = y if abs(y) > SMALLEST else math.copysign(SMALLEST, y)
    share, near = factor / wide, apart + (wide - y) / 2
    if abs(y) >= SHORT:
        _add_difference(pairs[_pair(j, k)], pairs[_pair(after_j, k)], near, x, steps, share, line)
        one, other = pairs[_pair(j, after_k)], pairs[_pair(after_j, after_k)]
        _add_difference(one, other, near - wide, x, steps, -share, line)
        return
    for end in (k, after_k):
        one, other = pairs[_pair(j, end)], pairs[_pair(after_j, end)]
        _add_difference(one, other, near, x, steps, share / 2, line)
        _add_difference(one, other, near - wide, x, steps, -share / 2, line)

"""Compiled loops of the coherence sum: a row of the plane at a time, pass after pass along it.

Along a row, q·(v_m − v_n) rises by the same step from one column to the next. So the table of a pair of
corners is also laid out in phases of that step: a stretch of a row then reads neighbouring numbers of the
two phases about its own, and blends them.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_streaks import Corners, Tables, add_near_streaks, columns_within, look_up

FAST = {"contract", "arcp", "nsz"}
# Places within so many table steps of each other have one value.
ALIKE = 0.01


@numba.njit(parallel=True, cache=True)
def lay_out_phases(
    pairs: NDArray[np.float32],
    reaches: NDArray[np.float64],
    steps: int,
    strides: NDArray[np.float64],
    counts: NDArray[np.int64],
    lengths: NDArray[np.int64],
    starts: NDArray[np.int64],
    out: NDArray[np.float32],
) -> None:
    """Lay the tables of pairs of corners out in phases of their step from column to column.

    Parameters
    ----------
    pairs : ndarray, shape (N, T, 4)
        Tables.
    reaches : ndarray, shape (N,)
        Where they end.
    steps : int
        Their entries per fringe.
    strides : ndarray, shape (N,)
        Fringes from column to column.
    counts, lengths, starts : ndarray, shape (N,)
        Phases of each pair, entries of each phase, and where the pair's begin; 0 phases for none.
    out : ndarray
        Written: (3, phases + 1, entries) of each pair, from −reach on.
    """
    for n in numba.prange(len(pairs)):
        count, length = counts[n], lengths[n]
        size = (count + 1) * length
        entry = np.zeros(4, dtype=np.float32)
        for phase in range(count + 1 if count else 0):
            for k in range(length):
                entry[:] = 0
                s = abs((k + phase / count) * strides[n] - reaches[n])
                look_up(pairs[n], s, steps, 1.0, entry)
                at = starts[n] + phase * length + k
                out[at], out[at + size], out[at + 2 * size] = entry[0], entry[1], entry[2]


@numba.njit(parallel=True, cache=True, error_model="numpy")
def fill_power(
    u: NDArray[np.float64],
    v: NDArray[np.float64],
    corners: Corners,
    tables: Tables,
    scale: float,
    mirrored: bool,
    out: NDArray[np.float32],
) -> None:
    """Write Σ_jk κ_j κ_k ⟨E_j, E_k⟩ / (16π⁴ |q|⁴) × scale at every frequency.

    Parameters
    ----------
    u, v : ndarray, shapes (C,) and (R,)
        Frequencies of columns and rows, cycles per unit of length.
    corners : Corners
        Of the opening.
    tables : Tables
        What is looked up.
    scale : float
        Factor of everything.
    mirrored : bool
        Whether the rows end at the axis and the columns are odd in number and centred on it: the
        other half of the plane is then written too.
    out : ndarray, shape (R, C, 3), or twice the rows where mirrored
        Written; where mirrored it may have one row or one column less than the whole plane.
    """
    count, columns = len(corners.vertices), len(u)
    for row in numba.prange(len(v)):
        tau = np.zeros((count, columns), dtype=np.float32)
        sums = np.empty((columns, 4), dtype=np.float32)
        lines = np.zeros((3, columns), dtype=np.float32)
        near = np.empty((count, 2), dtype=np.int64)
        _corner_weights(u, v[row], corners, tau, near, lines[0])
        _add_corners_alone(tau, tables.total, lines)
        _add_pairs(u, v[row], corners.vertices, tables, tau, lines)
        for column in range(columns):
            for channel in range(3):
                sums[column, channel] = lines[channel, column]
        add_near_streaks(u, v[row], corners, tables, near, tau, sums)
        _write(u, v[row], row, len(v) - 1, sums, scale, mirrored, out)


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _corner_weights(
    u: NDArray[np.float64],
    v: float,
    corners: Corners,
    tau: NDArray[np.float32],
    near: NDArray[np.int64],
    excess: NDArray[np.float32],
) -> None:
    """Write τ_m = κ_m / x_m − κ_{m−1} / x_{m−1} of the edges whose streak is not near, and where it is.

    The mean of 2 (κ / x)² over a pixel exceeds its value by 6 (κ / x)² ⟨δx²⟩ / x².
    """
    columns, vertices = len(u), corners.vertices
    inverse, quotient = np.empty(columns, dtype=np.float32), np.empty(columns, dtype=np.float32)
    for j in range(len(vertices)):
        k, weight, width = corners.following[j], corners.weights[j], np.float32(6 * corners.widths[j])
        ex, ey = vertices[k, 0] - vertices[j, 0], vertices[k, 1] - vertices[j, 1]
        low, high = columns_within(u, ex, v * ey, corners.limits[j])
        near[j, 0], near[j, 1] = low, high
        for column in range(columns):
            inverse[column] = np.float32(1) / np.float32(u[column] * ex + v * ey)
        inverse[low:high] = 0
        for column in range(columns):
            quotient[column] = np.float32((u[column] * ey - v * ex) * weight) * inverse[column]
        for column in range(columns):
            each = quotient[column] * inverse[column]
            excess[column] += width * (each * each)
        here, after = tau[j], tau[k]
        for column in range(columns):
            here[column] += quotient[column]
        for column in range(columns):
            after[column] -= quotient[column]


@numba.njit(cache=True, fastmath=FAST)
def _add_corners_alone(
    tau: NDArray[np.float32], total: NDArray[np.float64], lines: NDArray[np.float32]
) -> None:
    """Add Σ τ_m² to the first line, and start each channel with it times Γ(0)."""
    first = lines[0]
    for m in range(len(tau)):
        here = tau[m]
        for column in range(len(first)):
            first[column] += here[column] * here[column]
    for channel in (2, 1, 0):
        factor, line = np.float32(total[channel]), lines[channel]
        for column in range(len(first)):
            line[column] = first[column] * factor


@numba.njit(cache=True, fastmath=FAST)
def _add_pairs(
    u: NDArray[np.float64],
    v: float,
    vertices: NDArray[np.float64],
    tables: Tables,
    tau: NDArray[np.float32],
    lines: NDArray[np.float32],
) -> None:
    """Add 2 τ_m τ_n Γ(q·(v_m − v_n)) of all pairs in the columns where Γ lives."""
    factor = np.empty(len(u), dtype=np.float32)
    pair = -1
    for m in range(1, len(vertices)):
        for n in range(m):
            pair += 1
            dx, dy = vertices[m, 0] - vertices[n, 0], v * (vertices[m, 1] - vertices[n, 1])
            low, high = columns_within(u, dx, dy, tables.reaches[pair])
            if low >= high:
                continue
            one, other = tau[m], tau[n]
            for column in range(low, high):
                factor[column] = np.float32(2) * one[column] * other[column]
            if tables.counts[pair] == 0:
                _add_along(u, dx, dy, low, high, factor, tables.pairs[pair], tables.steps, lines)
                continue
            # Γ is even: the columns count in the direction in which q·(v_m − v_n) rises.
            place = math.copysign(1.0, dx) * (u[low] * dx + dy) + tables.reaches[pair]
            stride = abs(dx) * (u[1] - u[0])
            _add_phases(
                tables.phases, tables.starts[pair], tables.counts[pair], tables.lengths[pair], place, stride,
                factor[low:high], lines[:, low:high],
            )  # fmt: skip


@numba.njit(cache=True, fastmath=FAST)
def _add_phases(
    phases: NDArray[np.float32],
    start: int,
    count: int,
    length: int,
    place: float,
    stride: float,
    factor: NDArray[np.float32],
    lines: NDArray[np.float32],
) -> None:
    """Add factors times Γ along a stretch of a row that begins at a place after the tables' first."""
    place = max(place / stride, 0.0)
    whole = int(place)
    part = (place - whole) * count
    phase = min(int(part), count - 1)
    after = np.float32(part - phase)
    before = np.float32(1) - after
    size = (count + 1) * length
    for channel in range(3):
        at = start + channel * size + phase * length + whole
        one, other = phases[at : at + len(factor)], phases[at + length : at + length + len(factor)]
        line = lines[channel]
        for k in range(len(factor)):
            line[k] += factor[k] * (before * one[k] + after * other[k])


@numba.njit(cache=True, fastmath=FAST)
def _add_along(
    u: NDArray[np.float64],
    dx: float,
    dy: float,
    low: int,
    high: int,
    factor: NDArray[np.float32],
    table: NDArray[np.float32],
    steps: int,
    lines: NDArray[np.float32],
) -> None:
    """Add factors times Γ along a stretch of a row, one look-up after the other where they differ."""
    entry = np.zeros(4, dtype=np.float32)
    alike = abs(u[high - 1] - u[low]) * abs(dx) * steps < ALIKE
    if alike:
        look_up(table, u[low] * dx + dy, steps, 1.0, entry)
    for column in range(low, high):
        if not alike:
            entry[:] = 0
            look_up(table, u[column] * dx + dy, steps, 1.0, entry)
        for channel in range(3):
            lines[channel, column] += factor[column] * entry[channel]


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _write(
    u: NDArray[np.float64],
    v: float,
    row: int,
    axis: int,
    sums: NDArray[np.float32],
    scale: float,
    mirrored: bool,
    out: NDArray[np.float32],
) -> None:
    """Divide by |q|⁴ and write a row, and where mirrored the one that it is turned by 180 degrees."""
    columns = len(u)
    shared = scale / (16 * math.pi**4)
    for column in range(columns):
        square = u[column] * u[column] + v * v
        factor = np.float32(shared / (square * square)) if square > 0 else np.float32(0)
        for channel in range(3):
            sums[column, channel] = max(sums[column, channel] * factor, np.float32(0))
    shown = min(columns, out.shape[1])
    for column in range(shown):
        for channel in range(3):
            out[row, column, channel] = sums[column, channel]
    turned = 2 * axis - row
    if mirrored and turned != row and turned < out.shape[0]:
        for column in range(shown):
            for channel in range(3):
                out[turned, column, channel] = sums[columns - 1 - column, channel]

"""Compiled loops of the near field of straight-edged outlines, row by row, lengths in units of √(λz / 2).

A row's field is summed from what belongs to edges and what belongs to corners. An edge adds its winding and,
where the foot of the perpendicular lies on it, the wave of a whole straight edge; both are ranges of columns,
found in float64, so that they agree on every place. A corner adds exp(iπρ² / 2) times the smooth amplitudes
g(|h|, |s|) of its two edges, signed: a series far off, a polynomial near by (`corner` has both). Those loops
have no branches and run in float32 vectors; what passes through zero is counted from its zero.

Other wavelengths see the same places and edges times a scale: ranges of columns stay as they are, and a
corner's amplitudes are smooth in the scale, so that a few of them serve many wavelengths.
"""

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_arcs import FAST, HALF, ONE, TWO, auxiliary, cos_sin
from aureole.diffraction._kernels_corner import NEAR, STRETCH
from aureole.diffraction._kernels_near_polygons import Polygons, Tables, field_at, side_of

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
# Slope, shift and rest of what is linear over the columns; two of these, and a range of columns.
Line = tuple[np.float32, np.float32, np.float32]
End = tuple[Line, Line, tuple[np.float32, np.float32]]

# Columns that the loops of a corner's surroundings take at a time; rows of the plane are whole blocks.
BLOCK = 32
# Corners whose waves are summed in float32 before they go into a sum in float64.
AT_A_TIME = 8
# Places as near as this to a corner are computed in float64.
CLOSE = 1e-4
PER_TURN, PER_HALF_TURN = np.float32(1 / (2 * math.pi)), np.float32(1 / math.pi)
# The tail of a Fresnel integral is nothing from here on.
FLAT, TINY = np.float32(1e6), np.float32(1e-30)
# A block's buffers: x and y of the polynomial, min / max of |h| and |s|, sums, a row of the polynomial.
AT_X, AT_Y, RATIO, REAL, IMAG, PART, WORK = (k * BLOCK for k in (0, 1, 2, 3, 4, 5, 7))

# Scales between which a corner's amplitudes are interpolated.
STOPS = 6


class Scales(NamedTuple):
    """Several wavelengths, as scales of all lengths.

    every (W,) are their scales; stops (N,) those at which a corner's amplitudes are computed; shares (W, N)
    what each of these counts for each wavelength: N is STOPS, or stops are every one.
    """

    every: F64
    stops: F64
    shares: F32


@numba.njit(cache=True, parallel=True)
def fill_waves(points: F64, places: F64, out: F32) -> None:
    """Fill the cosine and the sine of π(point − place)² / 2.

    Parameters
    ----------
    points : ndarray, shape (V,)
        One coordinate of the corners.
    places : ndarray, shape (C,)
        The same coordinate of columns or rows.
    out : ndarray of float32, shape (V, 2, C)
        Filled.
    """
    for k in numba.prange(len(points)):
        for j in range(len(places)):
            away = points[k] - places[j]
            out[k, 0, j], out[k, 1, j] = cos_sin(0.25 * away * away)


@numba.njit(cache=True, parallel=True)
def add_rows(
    x: F64,
    y: F64,
    shape: Polygons,
    chunk: tuple[int, int],
    waves: tuple[F32, F32],
    table: tuple[F32, I64],
    out: NDArray[np.complex64],
) -> None:
    """Add what some corners, and the edges from them on, bring to a plane.

    Parameters
    ----------
    x, y : ndarray
        Of the columns, filled up to whole blocks, and of the rows.
    shape : Polygons
        All corners.
    chunk : tuple of int
        The first corner that counts, and the first that does not any more.
    waves : tuple of ndarray
        From `fill_waves`, of these corners: along x and along y.
    table : tuple of ndarray
        From `corner.corner_table`, in float32.
    out : ndarray of complex64, shape (rows, columns)
        Added to.
    """
    alone = np.ones(1)
    for row in numba.prange(len(y)):
        line, total = np.zeros((2, len(x)), np.float32), np.zeros((2, len(x)))
        windings = np.zeros((1, 2, len(x)), np.float32)
        work, amplitude = np.zeros(WORK, np.float32), np.empty((2, len(x)), np.float32)
        for k in range(chunk[0], chunk[1]):
            at = k - chunk[0]
            _edge(x, y[row], shape, k, alone, line.reshape(1, 2, -1), windings)
            _corner(x, y[row], shape, k, 1.0, table, work, amplitude)
            _turn(amplitude, waves[0][at], (waves[1][at, 0, row], waves[1][at, 1, row]), line)
            if at % AT_A_TIME == AT_A_TIME - 1 or k == chunk[1] - 1:
                _move(line, total)
        for j in range(out.shape[1]):
            out[row, j] += complex(total[0, j] + windings[0, 0, j], total[1, j])


@numba.njit(cache=True, parallel=True)
def mend_corners(x: F64, y: F64, shape: Polygons, tables: Tables, out: NDArray[np.complex64]) -> None:
    """Compute places that lie on corners, or nearly, in float64.

    Parameters
    ----------
    x, y : ndarray
        Of the columns and of the rows.
    shape, tables
        As of `field_at`.
    out : ndarray of complex64, shape (rows, columns)
        Some places are overwritten.
    """
    for row in numba.prange(len(y)):
        for k in range(len(shape.after)):
            first, after = _close(x, y[row], shape, k, CLOSE)
            for j in range(first, after):
                out[row, j] = field_at(x[j], y[row], shape, 1.0, tables)


@numba.njit(cache=True, parallel=True)
def add_colours(
    x: F64,
    y: F64,
    shape: Polygons,
    waves: tuple[F32, F32],
    table: tuple[F32, I64],
    tables: Tables,
    scales: Scales,
    weights: F32,
    total: F32,
) -> None:
    """Add the powers of several wavelengths to a plane in colour.

    Parameters
    ----------
    x, y : ndarray
        Of the columns, filled up to whole blocks, and of the rows.
    shape : Polygons
        In the same unit; all corners count.
    waves : tuple of ndarray of float32, shapes (W, V, 2, C) and (W, V, 2, R)
        From `fill_waves`, of each wavelength: along x and along y.
    table : tuple of ndarray
        From `corner.corner_table`, in float32.
    tables : Tables
        As of `field_at`.
    scales : Scales
        Of the wavelengths.
    weights : ndarray of float32, shape (W, 3)
        Of each wavelength for X, Y and Z.
    total : ndarray of float32, shape (R, 3, C)
        Added to.
    """
    count, columns = len(scales.every), total.shape[2]
    for row in numba.prange(len(y)):
        lines = np.zeros((count, 2, len(x)), np.float32)
        work, amplitudes = np.zeros(WORK, np.float32), np.empty((len(scales.stops), 2, len(x)), np.float32)
        for k in range(len(shape.after)):
            _edge(x, y[row], shape, k, scales.every, lines, lines)
            for n in range(len(scales.stops)):
                _corner(x, y[row], shape, k, scales.stops[n], table, work, amplitudes[n])
            for w in range(count):
                turn = waves[1][w, k, 0, row], waves[1][w, k, 1, row]
                if len(amplitudes) == STOPS:
                    _mix(amplitudes, scales.shares[w], waves[0][w, k], turn, lines[w])
                else:
                    _turn(amplitudes[w], waves[0][w, k], turn, lines[w])
        for w in range(count):
            for k in range(len(shape.after)):
                first, after = _close(x[:columns], y[row], shape, k, CLOSE / scales.every[w])
                for j in range(first, after):
                    value = field_at(x[j], y[row], shape, scales.every[w], tables)
                    lines[w, 0, j], lines[w, 1, j] = value.real, value.imag
            _add_power(lines[w], weights[w], total[row])


@numba.njit(cache=True)
def _move(line: F32, total: F64) -> None:
    """Add a line's float32 sums to those in float64, and begin them anew."""
    for part in range(2):
        for j in range(line.shape[1]):
            total[part, j] += line[part, j]
            line[part, j] = 0


@numba.njit(cache=True)
def _add_power(line: F32, weights: F32, total: F32) -> None:
    """Add a row's power to its three channels."""
    real, imag, (first, second, third) = line[0], line[1], total
    x, y, z = weights
    for j in range(len(first)):
        power = real[j] * real[j] + imag[j] * imag[j]
        first[j] += x * power
        second[j] += y * power
        third[j] += z * power


@numba.njit(cache=True)
def _close(x: F64, y: float, shape: Polygons, k: int, reach: float) -> tuple[int, int]:
    """Return the first column as near as this to a corner, and the first after."""
    if abs(shape.vertices[k, 1] - y) >= reach:
        return 0, 0
    base = shape.vertices[k, 0]
    return np.searchsorted(x, base - reach), np.searchsorted(x, base + reach, "right")


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _turn(amplitude: F32, along: F32, turn: tuple[np.float32, np.float32], line: F32) -> None:
    """Add a corner's wave: its amplitude times its phase."""
    cosines, sines, real, imag = along[0], along[1], line[0], line[1]
    cosine, sine = turn
    for j in range(len(real)):
        p, q = amplitude[0, j], amplitude[1, j]
        u, v = cosines[j] * cosine - sines[j] * sine, cosines[j] * sine + sines[j] * cosine
        real[j] += p * u - q * v
        imag[j] += p * v + q * u


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _mix(amplitudes: F32, shares: F32, along: F32, turn: tuple[np.float32, np.float32], line: F32) -> None:
    """Add a corner's wave, of amplitudes between those of some scales."""
    cosines, sines, real, imag = along[0], along[1], line[0], line[1]
    cosine, sine = turn
    a, b, c, d, e, f = shares[0], shares[1], shares[2], shares[3], shares[4], shares[5]
    A, B, C, D, E, F = (
        amplitudes[0],
        amplitudes[1],
        amplitudes[2],
        amplitudes[3],
        amplitudes[4],
        amplitudes[5],
    )
    for j in range(len(real)):
        p = a * A[0, j] + b * B[0, j] + c * C[0, j] + d * D[0, j] + e * E[0, j] + f * F[0, j]
        q = a * A[1, j] + b * B[1, j] + c * C[1, j] + d * D[1, j] + e * E[1, j] + f * F[1, j]
        u, v = cosines[j] * cosine - sines[j] * sine, cosines[j] * sine + sines[j] * cosine
        real[j] += p * u - q * v
        imag[j] += p * v + q * u


@numba.njit(cache=True)
def _negative(x: F64, origin: float, slope: float, rest: float, zero: bool) -> tuple[int, int]:
    """Return the first column where (origin − x) slope + rest is < 0, or 0 if `zero`, and the first after."""
    last = len(x) - 1
    value = (origin - x[0]) * slope + rest
    at_first = value < 0 or (zero and value == 0)
    value = (origin - x[last]) * slope + rest
    at_last = value < 0 or (zero and value == 0)
    if at_first == at_last:
        return (0, len(x)) if at_first else (0, 0)
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        value = (origin - x[middle]) * slope + rest
        if (value < 0 or (zero and value == 0)) == at_first:
            low = middle
        else:
            high = middle
    return (0, high) if at_first else (high, len(x))


@numba.njit(cache=True)
def _edge(x: F64, y: float, shape: Polygons, k: int, scales: F64, lines: F32, windings: F32) -> None:
    """Add an edge's winding, and its wave where the foot of the perpendicular lies on it, at each scale."""
    end, anchor = shape.after[k], shape.anchors[k]
    along_x, along_y = shape.directions[k]
    origin, rest = shape.vertices[anchor, 0], (y - shape.vertices[anchor, 1]) * along_x
    lower, upper = _negative(x, origin, along_y, rest, not side_of(0.0, along_x, along_y))
    weight = np.float32(shape.weights[k])
    low, high = shape.vertices[k, 1] <= y, shape.vertices[end, 1] <= y
    if low and not high:
        _add_to(windings, 0, lower, weight)
        _add_to(windings, upper, len(x), weight)
    elif high and not low:
        _add_to(windings, lower, upper, -weight)
    first, after = _negative(x, shape.vertices[k, 0], along_x, (shape.vertices[k, 1] - y) * along_y, False)
    begun, ended = _negative(
        x, shape.vertices[end, 0], along_x, (shape.vertices[end, 1] - y) * along_y, False
    )
    if ended > begun:
        first, after = (first, begun) if along_x > 0 else (ended, after)
    # Where h changes its sign so does the wave.
    for begin, stop, sign in (
        (first, min(after, lower), -weight),
        (max(first, lower), min(after, upper), weight),
        (max(first, upper), after, -weight),
    ):
        if begin < stop:
            for w in range(len(scales)):
                scale, part = scales[w], lines[w, :, begin:stop]
                _straight_wave(x[begin:stop], origin, scale * along_y, scale * rest, sign, part[0], part[1])


@numba.njit(cache=True)
def _add_to(lines: F32, first: int, after: int, value: np.float32) -> None:
    for w in range(len(lines)):
        line = lines[w, 0]
        for j in range(first, after):
            line[j] += value


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _straight_wave(
    x: F64, origin: float, slope: float, rest: float, sign: np.float32, real: F32, imag: F32
) -> None:
    """Add ±(1 − i) / 2 (E∞ − E(|h|)) along some columns."""
    half = HALF * sign
    for j in range(len(x)):
        h = (origin - x[j]) * slope + rest
        cosine, sine = cos_sin(0.25 * h * h)
        f, g = auxiliary(min(np.float32(abs(h)), FLAT))
        a, b = g * cosine - f * sine, g * sine + f * cosine
        real[j] += half * (a + b)
        imag[j] += half * (b - a)


@numba.njit(cache=True)
def _through_zero(value: float, slope: float) -> Line:
    """Return slope, shift and rest with value + slope j = slope (j + shift) + rest, the shift whole."""
    if abs(slope) < 1e-30:
        return np.float32(0), np.float32(0), np.float32(value)
    shift = np.rint(value / slope) if abs(value) < 4e6 * abs(slope) else 0.0
    return np.float32(slope), np.float32(shift), np.float32(value - shift * slope)


@numba.njit(cache=True)
def _end(x: F64, y: float, shape: Polygons, vertex: int, edge: int, scale: float) -> End:
    """Return h and s of an edge's end as lines over the columns, and the columns where s is negative."""
    along_x, along_y = shape.directions[edge]
    anchor = shape.anchors[edge]
    step = x[1] - x[0]
    h = (shape.vertices[anchor, 0] - x[0]) * along_y - (shape.vertices[anchor, 1] - y) * along_x
    rest = (shape.vertices[vertex, 1] - y) * along_y
    s = (shape.vertices[vertex, 0] - x[0]) * along_x + rest
    first, after = _negative(x, shape.vertices[vertex, 0], along_x, rest, False)
    return (
        _through_zero(scale * h, -scale * step * along_y),
        _through_zero(scale * s, -scale * step * along_x),
        (np.float32(first), np.float32(after)),
    )


@numba.njit(cache=True)
def _corner(
    x: F64,
    y: float,
    shape: Polygons,
    vertex: int,
    scale: float,
    table: tuple[F32, I64],
    work: F32,
    line: F32,
) -> None:
    """Fill the amplitude of a corner's wave along a row."""
    start = _end(x, y, shape, vertex, shape.before[vertex], scale)
    end = _end(x, y, shape, vertex, vertex, scale)
    across, base = shape.vertices[vertex, 1] - y, shape.vertices[vertex, 0]
    weight = np.float32(shape.weights[vertex])
    reach = math.sqrt(max((NEAR / scale) ** 2 - across * across, 0.0))
    first = np.searchsorted(x, base - reach)
    after = np.searchsorted(x, base + reach) if reach > 0 else first
    away = np.float32(scale * (base - x[0])), np.float32(scale * (x[1] - x[0])), np.float32(scale * across)
    if after - first < len(x):
        near = np.float32(first), np.float32(after)
        _far(start, end, away, near, weight, line)
    else:
        line[:] = np.float32(0)
    for low in range(first - first % BLOCK, after, BLOCK):
        near = np.float32(first - low), np.float32(after - low)
        part = line[0][low : low + BLOCK], line[1][low : low + BLOCK]
        _block(start, np.float32(low), table, work)
        _add_block(start, np.float32(low), near, weight, work, part)
        _block(end, np.float32(low), table, work)
        _add_block(end, np.float32(low), near, -weight, work, part)


@numba.njit(inline="always")
def _series(s: np.float32, inverse: np.float32) -> tuple[np.float32, np.float32]:
    """Return Σ (−1)^k m_k ρ^(−2k), five terms by the recurrence of the moments, each with its power."""
    imag, real = auxiliary(min(s, FLAT))
    step = inverse * PER_HALF_TURN
    turn = s * s * inverse
    total_real, total_imag = real, imag
    past_real, past_imag = real, imag
    real, imag = turn * real + step * imag, turn * imag - step * (real + s)
    total_real, total_imag = total_real + real, total_imag + imag
    odd, even = np.float32(3) * step, TWO * turn * step
    here_real, here_imag = real, imag
    real, imag = (
        turn * real + odd * imag - even * past_imag,
        turn * imag - odd * real + even * past_real,
    )
    total_real, total_imag = total_real + real, total_imag + imag
    past_real, past_imag = here_real, here_imag
    here_real, here_imag = real, imag
    odd, even = np.float32(5) * step, TWO * even
    real, imag = (
        turn * real + odd * imag - even * past_imag,
        turn * imag - odd * real + even * past_real,
    )
    total_real, total_imag = total_real + real, total_imag + imag
    past_real, past_imag = here_real, here_imag
    odd, even = np.float32(7) * step, np.float32(1.5) * even
    real, imag = (
        turn * real + odd * imag - even * past_imag,
        turn * imag - odd * real + even * past_real,
    )
    return total_real + real, total_imag + imag


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _far(
    start: End,
    end: End,
    away: Line,
    near: tuple[np.float32, np.float32],
    weight: np.float32,
    line: F32,
) -> None:
    """Fill a corner's amplitude where its series serves: g = h / (2πρ²) Σ (−1)^k m_k ρ^(−2k)."""
    (h0, m0, r0), (t0, n0, q0), (first0, after0) = start
    (h1, m1, r1), (t1, n1, q1), (first1, after1) = end
    base, step, across = away
    square, least = across * across, np.float32(NEAR * NEAR)
    first, after = near
    real, imag = line[0], line[1]
    scale = weight * PER_TURN
    for j in range(len(real)):
        place = np.float32(j)
        x = base - place * step
        inverse = ONE / max(x * x + square, least)
        a, b = _series(abs(t0 * (place + n0) + q0), inverse)
        c, d = _series(abs(t1 * (place + n1) + q1), inverse)
        here = h0 * (place + m0) + r0
        here = -here if place >= first0 and place < after0 else here
        there = h1 * (place + m1) + r1
        there = -there if place >= first1 and place < after1 else there
        size = scale * inverse
        size = np.float32(0) if place >= first and place < after else size
        real[j], imag[j] = size * (here * a - there * c), size * (here * b - there * d)


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _block(end: End, low: np.float32, table: tuple[F32, I64], work: F32) -> None:
    """Sum the polynomial of g near a corner at a block of columns."""
    (h, m, r), (t, n, q), _ = end
    coefficients, orders = table
    first = np.float32(1 / (1 + STRETCH * NEAR))
    scale, stretch = np.float32(2 / (1 - 1 / (1 + STRETCH * NEAR))), np.float32(STRETCH)
    for j in range(BLOCK):
        place = np.float32(j) + low
        across, along = abs(h * (place + m) + r), abs(t * (place + n) + q)
        most = max(max(across, along), TINY)
        ratio = min(across, along) / most
        work[AT_X + j] = scale * (ONE / (ONE + stretch * most) - first) - ONE
        work[AT_Y + j] = TWO * ratio * ratio - ONE
        work[RATIO + j] = ratio
        work[REAL + j] = np.float32(0)
        work[IMAG + j] = np.float32(0)
    for row in range(len(orders) - 1, -1, -1):
        for j in range(2 * BLOCK):
            work[PART + j] = np.float32(0)
        for k in range(orders[row] - 1, -1, -1):
            real, imag = coefficients[0, row, k], coefficients[1, row, k]
            for j in range(BLOCK):
                work[PART + j] = work[PART + j] * work[AT_X + j] + real
                work[PART + BLOCK + j] = work[PART + BLOCK + j] * work[AT_X + j] + imag
        for j in range(BLOCK):
            work[REAL + j] = work[REAL + j] * work[AT_Y + j] + work[PART + j]
            work[IMAG + j] = work[IMAG + j] * work[AT_Y + j] + work[PART + BLOCK + j]


@numba.njit(cache=True, error_model="numpy", fastmath=FAST)
def _add_block(
    end: End,
    low: np.float32,
    near: tuple[np.float32, np.float32],
    weight: np.float32,
    work: F32,
    line: tuple[F32, F32],
) -> None:
    """Add a corner's amplitude near it, from the polynomial and g(h, s) + g(s, h) = −i / 2 w(h) w(s)."""
    (h, m, r), (t, n, q), (first, after) = end
    real, imag = line
    for j in range(BLOCK):
        place = np.float32(j) + low
        across, s = h * (place + m) + r, abs(t * (place + n) + q)
        size = abs(across)
        f, g = auxiliary(min(size, FLAT))
        p, q_ = auxiliary(min(s, FLAT))
        a, b = work[RATIO + j] * work[REAL + j], work[RATIO + j] * work[IMAG + j]
        swapped_real = HALF * (g * p + f * q_) - a
        swapped_imag = HALF * (f * p - g * q_) - b
        a = a if size <= s else swapped_real
        b = b if size <= s else swapped_imag
        sign = weight if across > 0 else -weight
        sign = -sign if place >= first and place < after else sign
        sign = sign if np.float32(j) >= near[0] and np.float32(j) < near[1] else np.float32(0)
        real[j] += sign * a
        imag[j] += sign * b
